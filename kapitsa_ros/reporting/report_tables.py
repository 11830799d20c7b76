"""Tables 1 to 3 of the report, the rig's own figures beside those of 1997."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rich.table import Table

from kapitsa_ros.analysis.line_fit import fit_inverse_ols, fit_ols
from kapitsa_ros.configuration.tables import load_table
from kapitsa_ros.network.timing import UNTIMED
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.theory.averaged import omega_crit_averaged
from kapitsa_ros.reporting.budget_table import HEADINGS, budget_rows
from kapitsa_ros.units import INCH, RPM, decimals_within, interval_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


_BLANK = ('', '', '')
_SAME_SPEED = 0.02


def report_tables(values: Mapping[str, Any], plant: Plant) -> list[Table]:
    """Return the report's tables with a column of 1997 and a column of the rig."""
    return [_parameters(plant, values['ruler']), _measurements(values), _critical_speed(values)]


def budget_table(values: Mapping[str, Any]) -> Table:
    """Return the uncertainty budget."""
    table = Table(title='Uncertainty budget of the critical speed', title_justify='left')
    for heading in HEADINGS:
        table.add_column(heading, justify='left' if heading in ('input', 'type', 'distribution') else 'right')
    for row in budget_rows(values):
        table.add_row(*row)
    return table


def _parameters(plant: Plant, ruler: Mapping[str, float]) -> Table:
    table = _table('Table 1: experimental parameters', '', '1997', 'rig')
    report = Plant()
    for name, field in (('L', 'length'), ('λ', 'amplitude')):
        table.add_row(name, *(f'{getattr(each, field) / INCH:.4g} in' for each in (report, plant)))
    amplitude, sigma = (1e3 * ruler[name] for name in ('amplitude_m', 'sigma_m'))
    table.add_row('λ by the ruler', '', f'({amplitude:.3f} ± {sigma:.3f}) mm')
    return table


def _measurements(values: Mapping[str, Any]) -> Table:
    table = _table(
        'Table 2: experimental measurements', 'run', 'ω 1997 (RPM)', 'T 1997 (s)', 'Ω 1997 (RPM)',
        'ω rig (RPM)', 'T rig (s)', 'Ω rig (RPM)',
    )  # fmt: skip
    readings = load_table('1997')
    report = [
        (f'{omega / RPM:.0f}', f'{period:.2f}', f'{60 / period:.0f}')
        for omega, period in zip(readings.forcing, readings.period, strict=True)
    ]
    ours = _timings(values)
    asked = [row['speed_asked_rpm'] for row in values['timings']] or [_speed(run) for run in values['runs']]
    for row, of_1997 in beside_1997(asked, [omega / RPM for omega in readings.forcing.tolist()]):
        run, *measured = ('', *_BLANK) if row is None else ours[row]
        table.add_row(run, *(_BLANK if of_1997 is None else report[of_1997]), *measured)
    return table


def beside_1997(speeds: Sequence[float | None], of_1997: Sequence[float]) -> list[tuple[int | None, int | None]]:
    """Return the rows of Table 2: which of ours, by their speeds, stands beside which of 1997, in any one unit.

    Beside a speed of 1997 stands the last of ours at that speed, to one part in 50. Those of 1997 that nobody went
    back to follow at the end.
    """
    theirs: dict[int, int] = {}
    for index, speed in enumerate(of_1997):
        same = [row for row, ours in enumerate(speeds) if ours is not None and abs(ours / speed - 1.0) < _SAME_SPEED]
        theirs |= dict.fromkeys(same[-1:], index)
    rows: list[tuple[int | None, int | None]] = [(row, theirs.get(row)) for row in range(len(speeds))]
    return [*rows, *((None, index) for index in range(len(of_1997)) if index not in theirs.values())]


def _timings(values: Mapping[str, Any]) -> list[tuple[str, str, str, str]]:
    """Return run, speed, period and slow speed of each timing as read; where the motion was analysed, of each run."""
    if not values['timings']:
        return [
            (
                str(number),
                _number(_speed(run), '.1f'),
                'fell' if run['fell'] else _number(run['period_s'], '.3f'),
                _number(run['slow_rpm'], '.1f'),
            )
            for number, run in enumerate(values['runs'], start=1)
        ]
    rows = []
    for timing in values['timings']:
        timed = timing['display_s'] and timing['swings']
        period = timing['display_s'] / timing['swings'] if timed else None
        rows.append(
            (
                str(timing['run']),
                _number(timing['speed_reading_rpm'], '.1f'),
                timing['kind'] if period is None else f'{period:.3f}',
                '' if period is None else f'{60.0 / period:.1f}',
            )
        )
    return rows


def _speed(run: Mapping[str, Any]) -> float | None:
    """Return the speed that was taken for a run's motion, or read in it, RPM."""
    speed: float | None = run.get('speed_taken_rpm', run['speed_reading_rpm'])
    return speed


def ends(values: Mapping[str, Any]) -> list[str]:
    """Return what the kinds of end without a timing mean, of those that there were."""
    kinds = {timing['kind'] for timing in values['timings']}
    return [f'{kind}: {meaning}' for kind, meaning in UNTIMED.items() if kind in kinds]


def repairs(values: Mapping[str, Any]) -> list[str]:
    """Return what was repaired or left out of the readings, a sentence each."""
    said = []
    if any('speed_taken_rpm' in run for run in values.get('runs', ())):
        said.append('speeds are those asked for; periods are those of a small swing: what its width adds is taken off')
    for timing in values['timings']:
        if timing['unused'] is not None:
            said.append(f'run {timing["run"]}: {timing["kind"]}, left out: {timing["unused"]}')
        elif timing['alias'] is not None:
            said.append(
                f'run {timing["run"]}: read {timing["speed_reading_rpm"]:.1f} RPM, '
                f'taken as {timing["speed_taken_rpm"]:.1f} RPM: alias {timing["alias"]} '
                f'({timing["speed_asked_rpm"]:.0f} RPM was asked for)'
            )
        if timing['miscount'] is not None:
            said.append(timing['miscount'])
    return list(dict.fromkeys(said))


def _critical_speed(values: Mapping[str, Any]) -> Table:
    table = _table('Table 3: critical stabilising forcing frequency', '', '1997', 'rig')
    readings = load_table('1997')
    predicted = omega_crit_averaged(Plant())
    fitted = {'inverse_rpm': fit_inverse_ols(readings).omega_crit, 'ols_rpm': fit_ols(readings).omega_crit}
    for label, key in (('experiment: ω² on Ω², as in 1997', 'inverse_rpm'), ('experiment: Ω² on ω²', 'ols_rpm')):
        table.add_row(label, _number((fitted[key] or 0) / RPM, '.1f', ' RPM'), _number(values[key], '.1f', ' RPM'))
    table.add_row('predicted', _number(predicted / RPM, '.1f', ' RPM'), _number(values['predicted_rpm'], '.1f', ' RPM'))
    error = 100 * ((fitted['inverse_rpm'] or 0) / predicted - 1)
    table.add_row('deviation of the fit of 1997', f'{error:+.1f} %', _number(values['error_percent'], '+.1f', ' %'))
    interval = tuple(values['omega_crit_interval_rpm'] or (None, None))
    form = f'.{decimals_within(interval)}f'
    table.add_row('best estimate: the exact curve', '', _number(values['omega_crit_rpm'], form, ' RPM'))
    ends = 'none' if interval == (None, None) else f'{interval_text(interval, f"{{:{form}}}".format)} RPM'
    table.add_row('its 95 % interval', '', ends)
    if values['omega_crit_rpm'] is not None and values['discrepancy_percent'] != 0.0:
        table.add_row(
            'uncertainty of T beyond the stated', '', _number(values['discrepancy_percent'], '.2g', ' % allowed for')
        )
    table.add_row('exact threshold of the plant simulated', '', _number(values['truth_rpm'], '.2f', ' RPM'))
    table.add_row('deviation of the best estimate from it', '', _number(values['deviation_percent'], '+.2f', ' %'))
    return table


def _table(title: str, *columns: str) -> Table:
    table = Table(title=title, title_justify='left')
    for column in columns:
        table.add_column(column, justify='right' if column else 'left')
    return table


def _number(value: float | None, form: str, unit: str = '') -> str:
    return 'none' if value is None else f'{value:{form}}{unit}'
