"""Results under the names that the command line, the topics and the reports share."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from kapitsa_ros.units import RPM, in_rpm

if TYPE_CHECKING:
    from kapitsa_ros.analysis.critical_speed import Budget
    from kapitsa_ros.analysis.experiment import Experiment
    from kapitsa_ros.analysis.timing_row import TimingRow
    from kapitsa_ros.network.run import Run


def run_values(run: Run) -> dict[str, Any]:
    """Return what the readings of one run say."""
    return {
        'speed_reading_rpm': in_rpm(run.speed_reading),
        'period_s': run.period,
        'slow_rpm': None if run.period is None else 60.0 / run.period,
        'fell': run.fell,
    }


def motion_values(run: Run, period: float | None) -> dict[str, Any]:
    """Return what the readings of one run say, and the speed and the small swing's period, s, taken of its motion."""
    return run_values(run) | {
        'speed_taken_rpm': in_rpm(run.speed_asked),
        'period_s': period,
        'slow_rpm': None if period is None else 60.0 / period,
    }


def experiment_values(experiment: Experiment) -> dict[str, Any]:
    """Return what the runs say together."""
    interval = experiment.interval
    return {
        'omega_crit_rpm': in_rpm(experiment.omega_crit),
        'omega_crit_interval_rpm': None if interval is None else [in_rpm(end) for end in interval],
        'discrepancy_percent': None if experiment.discrepancy is None else 100.0 * experiment.discrepancy,
        'play_probability': experiment.play_probability,
        'heavy_damping_probability': experiment.heavy_damping_probability,
        'effective_rods': experiment.effective_rods,
        'assumptions': asdict(experiment.assumptions),
        'inverse_rpm': in_rpm(experiment.inverse_ols),
        'ols_rpm': in_rpm(experiment.ols),
        'predicted_rpm': in_rpm(experiment.predicted),
        'error_percent': experiment.error_percent,
        'truth_rpm': in_rpm(experiment.truth),
        'deviation_percent': experiment.deviation_percent,
        'ruler': {'amplitude_m': experiment.ruler.amplitude, 'sigma_m': experiment.ruler.sigma},
        'timings': [timing_values(row) for row in experiment.timings],
    }


def budget_values(budget: Budget) -> dict[str, Any]:
    """Return an uncertainty budget; sensitivities are in RPM over the unit of the input."""
    return {
        'inputs': [
            {
                'name': row.name,
                'value': row.value,
                'unit': row.unit,
                'u': row.u,
                'type': row.kind,
                'distribution': row.distribution,
                'degrees_of_freedom': row.freedom,
                'sensitivity_rpm': row.sensitivity / RPM,
                'contribution_rpm': row.contribution / RPM,
            }
            for row in budget.rows
        ],
        'correlations': [list(each) for each in budget.correlations],
        'value_rpm': budget.value / RPM,
        'u_rpm': budget.u / RPM,
        'degrees_of_freedom': budget.freedom,
        'coverage_factor': budget.k,
        'expanded_rpm': budget.expanded / RPM,
        'monte_carlo': {
            'draws': budget.draws,
            'value_rpm': budget.monte_carlo_value / RPM,
            'u_rpm': budget.monte_carlo_u / RPM,
            'interval_rpm': [end / RPM for end in budget.monte_carlo_interval],
        },
        'linear': budget.is_linear,
    }


def timing_values(row: TimingRow) -> dict[str, Any]:
    """Return what a timing was read as, and what it is taken for."""
    return {
        'run': row.run,
        'speed_asked_rpm': in_rpm(row.speed_asked),
        'speed_reading_rpm': in_rpm(row.speed_reading),
        'speed_taken_rpm': in_rpm(row.speed),
        'alias': None if row.alias is None else str(row.alias),
        'release_rad': row.release,
        'kind': row.kind,
        'display_s': row.displayed,
        'swings': row.swings,
        'swings_taken': row.swings_taken,
        'miscount_probability': row.miscount_probability,
        'miscount': row.miscount,
        'time_s': row.time,
        'unused': row.unused,
    }
