"""Motions that others have recorded, as a joint: a bag without readings, on a plant that is told."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from kapitsa_ros import __version__
from kapitsa_ros.analysis.assumptions import DEFAULT_ASSUMPTIONS
from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.analysis.experiment import reduce_motions
from kapitsa_ros.analysis.recorded_run import RecordedRun
from kapitsa_ros.analysis.results import experiment_values, motion_values
from kapitsa_ros.analysis.slow_frequency import DEFAULT_ESTIMATOR
from kapitsa_ros.analysis.uneven_series import even_series
from kapitsa_ros.file_name_text import shown_name
from kapitsa_ros.network.run import Run
from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.recording.joint_samples import read_joint
from kapitsa_ros.recording.naming import name_of
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from kapitsa_ros.analysis.assumptions import Assumptions
    from kapitsa_ros.physics.plant import Plant

_TURN = 0.25
"""Of the shaft: a gap that is wider hides what the pivot does."""


def analyse_joints(
    paths: Sequence[Path],
    joint: str,
    speeds: Sequence[float],
    plant: Plant,
    *,
    estimator: str = DEFAULT_ESTIMATOR,
    assumptions: Assumptions = DEFAULT_ASSUMPTIONS,
) -> dict[str, Any]:
    """Analyse the motion of a joint in bags of any origin.

    Parameters
    ----------
    paths
        Of the bags, one a run.
    joint
        Name of the joint whose position is the angle from the upright.
    speeds
        Of the shaft, rad/s: one for each bag.
    plant
        What was recorded, as far as it is known.
    estimator
        Of the slow frequency: a name in `ESTIMATORS`.
    assumptions
        On rod and instruments.

    Raises
    ------
    BagError
        A bag cannot be read, or has no such joint.
    AnalysisError
        There are not as many speeds as bags, one is not above 0, or a motion shows no swing.

    """
    if len(speeds) != len(paths):
        raise AnalysisError(f'{len(speeds)} speeds for {len(paths)} bags: give one for each, in their order')
    if any(speed <= 0.0 for speed in speeds):
        raise AnalysisError(f'a speed of {min(speeds) / RPM:g} RPM: the shaft has to turn, give one above 0')
    recorded, runs = [], []
    for number, (path, speed) in enumerate(zip(paths, speeds, strict=True), start=1):
        samples = read_joint(path, joint)
        seconds = (samples.stamps_ns - samples.stamps_ns[:1]) / SECOND
        try:
            series = even_series(seconds, samples.position, samples.rate, _TURN * 2.0 * math.pi / speed)
        except AnalysisError as error:
            raise AnalysisError(f'{path}: {error}') from error
        low, high = float(series.value.min()), float(series.value.max())
        if low > 0.0 or high < 0.0:
            raise AnalysisError(
                f'{path}: {joint} stays between {low:.3g} and {high:.3g} rad and never passes 0, the upright: '
                'θ is counted from there'
            )
        run = Run(
            number=number,
            settings={'pendulum': {'plant': asdict(plant)}, 'jigsaw': {'amplitude': plant.amplitude}},
            speed_asked=speed,
            release=None,
            readings={},
            timings=(),
            complete=True,
        )
        recorded.append(RecordedRun(name=shown_name(name_of(path)), run=run, time=series.time, angle=series.value))
        runs.append(
            {
                'bag': str(path),
                'run': number,
                'samples': int(samples.position.size),
                'gaps': series.gaps,
                'digest_ok': None,
                'defects': [*samples.defects, *series.defects],
            }
        )
    experiment, found = reduce_motions(recorded, estimator, assumptions)
    for values, each, period in zip(runs, recorded, found.period, strict=True):
        values.update(motion_values(each.run, float(period)))
    told = {'plant': asdict(plant), 'instruments': None, 'protocol': None, 'seed': None, 'version': __version__}
    # What is told of the plant is no truth.
    unknown = {'truth_rpm': None, 'deviation_percent': None}
    return {'runs': runs} | experiment_values(experiment) | unknown | told
