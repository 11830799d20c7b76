"""The report on a campaign: how often intervals hold, and how far estimates deviate, by each factor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from jinja2 import Environment, StrictUndefined

from kapitsa_ros.analysis.share_range import share_range
from kapitsa_ros.laboratory.campaign_file import OUTCOME_COLUMNS
from kapitsa_ros.reporting.campaign_text import seed_text
from kapitsa_ros.reporting.figures.canvas import BLUE, INK, blank, house_style
from kapitsa_ros.reporting.report.document import Document, drawings_named
from kapitsa_ros.reporting.report.text import plain
from kapitsa_ros.resources import resource_path

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from matplotlib.figure import Figure
    from numpy.typing import NDArray

MOST_LEVELS = 8
"""Values of a factor that stand by themselves; more are taken together in groups."""
_NOMINAL = 0.95


@dataclass(frozen=True, kw_only=True, eq=False)
class Level:
    """The experiments at one value of a factor, or at a group of values."""

    name: str
    experiments: int
    failed: int
    held: int
    """Intervals that hold the truth, of the experiments that gave a critical speed."""
    deviation: tuple[float, float, float]
    """Of the estimates from the truth, relative: median, 16th and 84th percentile; nan without any."""
    width: float
    """Median of the intervals over the truth; nan where none has two ends."""
    unbounded: int

    @property
    def given(self) -> int:
        """Experiments that gave a critical speed."""
        return self.experiments - self.failed

    @property
    def share(self) -> float:
        """Of the intervals that hold."""
        return self.held / self.given if self.given else np.nan

    @property
    def share_range(self) -> tuple[float, float]:
        """95 % range of that share, by Clopper and Pearson."""
        return share_range(self.held, self.given)


def level_of(name: str, columns: Mapping[str, NDArray[Any]], chosen: NDArray[np.bool_]) -> Level:
    """Sum up the chosen rows of a campaign's outcomes, of which null is nan."""
    truth, value, low, high = (columns[key][chosen] for key in ('truth_rpm', 'omega_crit_rpm', 'low_rpm', 'high_rpm'))
    given = np.isfinite(value)
    holds = given & ~(low > truth) & ~(high < truth)  # an end that is nan excludes nothing
    bounded = given & np.isfinite(low) & np.isfinite(high)
    deviation = np.quantile(value[given] / truth[given] - 1.0, (0.5, 0.16, 0.84)) if given.any() else np.full(3, np.nan)
    return Level(
        name=name,
        experiments=int(chosen.sum()),
        failed=int((~given).sum()),
        held=int(holds.sum()),
        deviation=(float(deviation[0]), float(deviation[1]), float(deviation[2])),
        width=float(np.median((high - low)[bounded] / truth[bounded])) if bounded.any() else np.nan,
        unbounded=int((given & ~bounded).sum()),
    )


def levels_of(factor: str, columns: Mapping[str, NDArray[Any]]) -> list[Level]:
    """Sum up outcomes by the values of a factor."""
    values = columns[factor]
    distinct, counts = np.unique(values, return_counts=True)
    if values.dtype.kind in 'OU':
        return [level_of(str(each), columns, values == each) for each in distinct.tolist()]
    names = _apart(distinct.tolist())
    if distinct.size <= MOST_LEVELS:
        return [level_of(name, columns, values == each) for name, each in zip(names, distinct, strict=True)]
    middles = (np.cumsum(counts) - 0.5 * counts) / values.size  # a value is in the group in which most of it is
    groups = np.minimum((MOST_LEVELS * middles).astype(int), MOST_LEVELS - 1)
    levels = []
    for group in np.unique(groups):
        first, last = np.flatnonzero(groups == group)[[0, -1]].tolist()
        name = names[first] if first == last else f'{names[first]} to {names[last]}'
        levels.append(level_of(name, columns, (distinct[first] <= values) & (values <= distinct[last])))
    return levels


def _apart(values: Sequence[float]) -> list[str]:
    """Return values in as few digits as tell them apart, four at least."""
    for digits in range(4, 17):
        names = [f'{value:.{digits}g}' for value in values]
        if len(set(names)) == len(names):
            break
    return names


def campaign_document(columns: Mapping[str, NDArray[Any]], units: Mapping[str, str], version: str) -> Document:
    """Return the report.

    Parameters
    ----------
    columns
        Of the campaign's file, each of shape (N,), with nan for null; text in columns of strings.
    units
        Of the factors, where they have any.
    version
        Of the package that carried the campaign out.

    """
    names = [name for name in columns if name not in (*OUTCOME_COLUMNS, 'failure')]
    titles = {name: name.replace('_', ' ') + (f' ({units[name]})' if units.get(name) else '') for name in names}
    every = level_of('all', columns, np.ones(columns['seed'].size, dtype=np.bool_))
    by_factor = {name: levels_of(name, columns) for name in names}
    with house_style():
        figures = [
            (_figure(titles[name], levels), 'Bars are 95 % ranges above, and 68 % of the experiments below.')
            for name, levels in by_factor.items()
        ]
    drawings = drawings_named(figures)
    points = int(columns['point'].max())
    environment = Environment(undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)  # noqa: S701 - Markdown
    environment.filters['plain'] = plain
    template = environment.from_string(resource_path('config', 'report', 'campaign.md').read_text(encoding='utf-8'))
    text = template.render(
        points=points,
        experiments=every.experiments,
        each=every.experiments // points,
        version=version,
        overall=_cells(every),
        factors=[
            {
                'title': name.replace('_', ' '),
                'heading': titles[name],
                'levels': [_cells(level) for level in levels],
                'figure': drawing,
            }
            for (name, levels), drawing in zip(by_factor.items(), drawings, strict=True)
        ],
        reasons=_reasons(columns),
        given=every.given,
        most_levels=MOST_LEVELS,
    )
    return Document(title='Virtual experiments', text=text.strip() + '\n', drawings=drawings)


def _reasons(columns: Mapping[str, NDArray[Any]]) -> list[dict[str, Any]]:
    """Return why experiments gave no critical speed, the most frequent reason first, with seeds to repeat them."""
    found: dict[str, list[int]] = {}
    for reason, seed in zip(columns['failure'].tolist(), columns['seed'].tolist(), strict=True):
        if reason:
            found.setdefault(reason, []).append(seed)
    often = sorted(found.items(), key=lambda item: -len(item[1]))
    return [{'reason': reason, 'count': len(seeds), 'seeds': seed_text(seeds)} for reason, seeds in often]


def _cells(level: Level) -> dict[str, Any]:
    median, low, high = (100.0 * each for each in level.deviation)
    given = level.given > 0
    return {
        'name': level.name,
        'experiments': level.experiments,
        'failed': level.failed,
        'held': f'{100.0 * level.share:.1f} %' if given else 'none',
        'range': '{:.0f} to {:.0f} %'.format(*(100.0 * end for end in level.share_range)) if given else '',
        'bias': f'{median:+.2f} %' if given else 'none',
        'spread': f'{low:+.1f} to {high:+.1f} %' if given else '',
        'width': f'{100.0 * level.width:.1f} %' if np.isfinite(level.width) else 'none',
        'unbounded': level.unbounded,
    }


def _figure(name: str, levels: Sequence[Level]) -> Figure:
    """Draw the share of intervals that hold and the deviation of the estimates, by the levels of a factor."""
    figure = blank(f'Intervals and estimates by {name}', 2, stacked=True)
    upper, lower = figure.axes
    for place, level in enumerate(levels):
        if not level.given:
            continue
        upper.plot([place, place], [100.0 * end for end in level.share_range], color=BLUE)
        upper.plot(place, 100.0 * level.share, 'o', color=BLUE)
        median, low, high = (100.0 * each for each in level.deviation)
        lower.plot([place, place], [low, high], color=BLUE)
        lower.plot(place, median, 'o', color=BLUE)
    upper.axhline(100.0 * _NOMINAL, color=INK, linewidth=0.8, linestyle='--')
    lower.axhline(0.0, color=INK, linewidth=0.8)
    upper.set(ylabel='intervals that hold (%)')
    lower.set(xlabel=name, ylabel='deviation of the estimate (%)')
    for axes in (upper, lower):
        axes.set_xticks(range(len(levels)), [level.name for level in levels], fontsize=7)
    return figure
