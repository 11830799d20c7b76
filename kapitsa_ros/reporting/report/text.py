"""The report's text, in Markdown: the one source of all its formats."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import TYPE_CHECKING

from jinja2 import Environment, StrictUndefined

from kapitsa_ros import __version__
from kapitsa_ros.analysis.experiment import ideal_rod
from kapitsa_ros.analysis.results import budget_values, timing_values
from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
from kapitsa_ros.instruments.strobe_settings import StrobeSettings
from kapitsa_ros.laboratory.preset_plans import TARGET_PERCENT
from kapitsa_ros.laboratory.preset_trials import AS_BUILT_ON_BEARING
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.physics.theory.averaged import omega_crit_averaged
from kapitsa_ros.physics.theory.floquet import omega_crit_exact, slow_frequency_exact
from kapitsa_ros.reporting.allowances import allowances
from kapitsa_ros.reporting.budget_table import HEADINGS, budget_rows, budget_sentences
from kapitsa_ros.reporting.explanation import HEADINGS as CAUSE_HEADINGS
from kapitsa_ros.reporting.explanation import error_sentences, explanation_rows
from kapitsa_ros.reporting.report_tables import beside_1997, ends, repairs
from kapitsa_ros.resources import resource_path
from kapitsa_ros.schema import describe
from kapitsa_ros.units import INCH, RPM, counted, decimals_within, interval_text, is_within

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kapitsa_ros.network.run import Run
    from kapitsa_ros.reporting.report.content import Content
    from kapitsa_ros.reporting.report.document import Drawing
    from kapitsa_ros.schema import Quantity

_INSTRUMENTS = {'strobe': StrobeSettings, 'stopwatch': StopwatchSettings}
_MARKED = str.maketrans({sign: f'\\{sign}' for sign in '\\`*_[]<>|#'})


def report_text(content: Content, drawings: Sequence[Drawing]) -> str:
    """Return the report in Markdown; a figure stands on a line of its own, under its drawing's name."""
    environment = Environment(  # noqa: S701 - Markdown; what becomes HTML of it is escaped there
        undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.globals.update(error_sentences=error_sentences, explanation_rows=explanation_rows, is_within=is_within)
    environment.filters.update(
        rpm=_rpm, rpm_within=_rpm_within, inch=_inch, number=_number, counted=counted, ends=_ends, plain=plain,
        sentence=_sentence, budget_rows=budget_rows, budget_sentences=budget_sentences,
    )  # fmt: skip
    template = environment.from_string(resource_path('config', 'report', 'report.md').read_text(encoding='utf-8'))
    timings = [timing_values(row) for row in content.timings]
    report, curve = Plant(), content.curve
    slow = [slow_frequency_exact(report, speed) for speed in content.of_1997.forcing.tolist()]
    text = template.render(
        content=content,
        timings=timings,
        measurements=beside_1997(
            [timing['speed_asked_rpm'] for timing in timings], (content.of_1997.forcing / RPM).tolist()
        ),
        repairs=[*ends({'timings': timings}), *_of_records(content), *repairs({'timings': timings})],
        allowances=allowances(
            asdict(content.assumptions),
            curve.play_probability if curve else None,
            curve.heavy_damping_probability if curve else None,
            curve.effective_rods if curve else None,
        ),
        budget=None if content.budget is None else budget_values(content.budget),
        budget_headings=HEADINGS,
        report=report,
        nominal=ideal_rod(content.plant),
        cause_headings=CAUSE_HEADINGS,
        plant=_items(Plant, asdict(content.plant)),
        instruments=_instruments(content.runs[0].run),
        seeds=list(dict.fromkeys(run.run.settings['strobe'].get('seed', 'not recorded') for run in content.runs)),
        instruments_differ=len({repr(_instruments(run.run)) for run in content.runs}) > 1,
        version=__version__,
        theory_slow=[f'{(each or 0.0) / RPM:.0f}' for each in slow],
        read_slow=[f'{each / RPM:.0f}' for each in content.of_1997.slow.tolist()],
        trials={trial.name: trial for trial in content.trials},
        as_built_on_bearing=AS_BUILT_ON_BEARING,
        figures=drawings,
        exact_over_averaged=omega_crit_exact(report) / omega_crit_averaged(report),
        rpm_unit=RPM,
        inch_unit=INCH,
        target=TARGET_PERCENT,
    )
    return text.strip() + '\n'


def _instruments(run: Run) -> dict[str, list[tuple[Quantity, float]]]:
    return {name: _items(kind, run.settings[name]['instrument']) for name, kind in _INSTRUMENTS.items()}


def _items(kind: type, values: Mapping[str, float]) -> list[tuple[Quantity, float]]:
    """Return the parameters of a set that values are given of, and the values."""
    return [(item, values[item.name]) for item in describe(kind) if item.name in values]


def plain(text: str) -> str:
    """Return a text in which nothing is taken for markup."""
    return text.translate(_MARKED)


def _sentence(text: str) -> str:
    return text[:1].upper() + text[1:]


def _rpm(speed: float | None, digits: int = 1) -> str:
    return 'none' if speed is None or math.isnan(speed) else f'{speed / RPM:.{digits}f}'


def _inch(length: float) -> str:
    return f'{length / INCH:.4g} in'


def _number(value: float | None, digits: int = 3) -> str:
    return '' if value is None else f'{value:.{digits}g}'


def _ends(interval: tuple[float | None, float | None] | None) -> str:
    if interval is None:
        return ''
    return interval_text(interval, lambda end: _rpm(end, decimals_within(interval, RPM)))


def _rpm_within(speed: float | None, interval: tuple[float | None, float | None] | None) -> str:
    return _rpm(speed) if interval is None else _rpm(speed, decimals_within(interval, RPM))


def _of_records(content: Content) -> list[str]:
    """Return what is missing in the bags, and which of them nothing verifies, a sentence each."""
    said = [f'{run.name}: {defect}' for run in content.runs for defect in run.defects]
    if unverified := [run.name for run in content.runs if run.unverified]:
        said.append(f'Unverified, as no digest is recorded with them: {", ".join(unverified)}')
    return [plain(sentence) for sentence in dict.fromkeys(said)]
