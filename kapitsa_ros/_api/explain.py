"""`explain`: which causes fit a table of readings."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

from kapitsa_ros._api.inputs import as_plant, as_timings
from kapitsa_ros._api.result import describe
from kapitsa_ros.analysis.critical_speed import evidence_of
from kapitsa_ros.analysis.explain import explain as rank
from kapitsa_ros.data_frame import data_frame

if TYPE_CHECKING:
    import pandas as pd

    from kapitsa_ros._api.inputs import AnyPlant, AnyReadings
    from kapitsa_ros.analysis.explain import Explanation, OtherErrors


@dataclass(frozen=True, kw_only=True, repr=False)
class Explanations:
    """Which causes fit, best first."""

    explanations: tuple[Explanation, ...]
    indistinguishable: tuple[str, ...]
    """Those that the readings cannot tell apart."""
    period_sigma: tuple[float, float]
    """Smallest and largest uncertainty stated of a period, s."""
    with_other_errors: tuple[OtherErrors, ...]
    """The ranking with the uncertainties of the periods halved, doubled and fitted."""
    warnings: tuple[str, ...]

    def __repr__(self) -> str:
        fitting = [explanation.name for explanation in self.explanations if explanation.fits]
        return describe(
            f'Explanations: {len(self.explanations)} causes tried',
            fitting=', '.join(fitting) or 'none',
            indistinguishable=', '.join(self.indistinguishable) or 'none',
            warnings='; '.join(self.warnings) or 'none',
        )

    def to_pandas(self) -> pd.DataFrame:
        """Return a row a cause; `value` and its interval are in SI units."""
        rows = [asdict(explanation) for explanation in self.explanations]
        ends = [row.pop('interval') or (None, None) for row in rows]
        columns = {name: [row[name] for row in rows] for name in rows[0]}
        columns['rms_misfit_s'] = columns.pop('rms_misfit')
        return data_frame(columns | {'low': [low for low, _ in ends], 'high': [high for _, high in ends]})


def explain(readings: AnyReadings = '1997', plant: AnyPlant = None) -> Explanations:
    """Rank the causes that could have made the periods of a table what they are.

    Parameters
    ----------
    readings
        A table, by its name or path; or columns: `(speed, period)`, and where known their standard uncertainties.
    plant
        What it should have been: a `Plant`, or a preset by its name or path; the report's ideal rod where not given.

    Returns
    -------
    Explanations
        With `.warnings` and `.to_pandas()`.

    Raises
    ------
    KapitsaError
        The table cannot be read, or has fewer than two speeds.

    Examples
    --------
    >>> import kapitsa_ros as kr
    >>> 'inertia_factor' in kr.explain('1997').indistinguishable
    True

    """
    table = as_timings(readings)
    evidence = evidence_of(table.rows)
    ranking = rank(evidence.timed, as_plant(plant))
    untimed = len(evidence.fell) + len(evidence.stood)
    passed_over = (f'{untimed} swings that were not timed have no period to explain',) if untimed else ()
    return Explanations(
        explanations=ranking.explanations,
        indistinguishable=ranking.indistinguishable,
        period_sigma=ranking.period_sigma,
        with_other_errors=ranking.with_other_errors,
        warnings=(*table.warnings, *passed_over, *ranking.warnings),
    )
