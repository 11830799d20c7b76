"""The critical speed from a table of readings, in a table and sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rich.table import Table

from kapitsa_ros.units import decimals_within, interval_text

if TYPE_CHECKING:
    from collections.abc import Mapping

_FITS: tuple[tuple[str, str, str | None], ...] = (
    ('exact curve, the best estimate', 'omega_crit_rpm', 'omega_crit_interval_rpm'),
    ('inverse least squares, the fit of the report', 'inverse_rpm', None),
    ('ordinary least squares', 'ols_rpm', None),
    ('errors in variables', 'eiv_rpm', 'eiv_interval_rpm'),
    ('predicted by averaged theory (eq. 8)', 'predicted_rpm', None),
)


def reduction_table(values: Mapping[str, Any]) -> Table:
    """Return each estimate of the critical speed with its interval."""
    table = Table(title='Critical speed (RPM)', title_justify='left')
    for heading in ('by', 'ω_crit', '95 %'):
        table.add_column(heading, justify='left' if heading == 'by' else 'right')
    for label, key, interval in _FITS:
        value, bounds = values[key], None if interval is None else tuple(values[interval])
        form = '{:.1f}' if bounds is None else f'{{:.{decimals_within(bounds)}f}}'
        ends = '' if bounds is None else interval_text(bounds, form.format)
        table.add_row(label, 'none' if value is None else form.format(value), ends)
    return table


def reduction_sentences(values: Mapping[str, Any], *, untold_releases: int) -> list[str]:
    """Return how the fits stand to theory, and what was assumed of the swings."""
    said = []
    if values['error_percent'] is not None:
        said.append(f'the inverse fit deviates by {values["error_percent"]:+.1f} % from the prediction')
    if values['slope_ratio'] is not None:
        said.append(f'slope of its line over that of theory: {values["slope_ratio"]:.3f}')
    if untold_releases:
        said.append(f'timings without a release angle are taken as small swings: {untold_releases}')
    return said
