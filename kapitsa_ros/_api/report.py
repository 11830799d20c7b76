"""`report`: one file about recorded runs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from kapitsa_ros._api.inputs import as_assumptions, as_readings
from kapitsa_ros._api.result import describe, speed_text
from kapitsa_ros.errors import OPTION, OutputError
from kapitsa_ros.extras import import_of_extra
from kapitsa_ros.output_file import check_output, replacing
from kapitsa_ros.recording.naming import repeats, run_folders
from kapitsa_ros.recording.reader import runs_of
from kapitsa_ros.units import counted

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from kapitsa_ros._api.inputs import AnyAssumptions
    from kapitsa_ros.recording.reader import RunBag
    from kapitsa_ros.reporting.report.content import Content
    from kapitsa_ros.reporting.report.document import Document


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Report:
    """A page that was written, and the numbers in it."""

    output: Path
    content: Content
    warnings: tuple[str, ...]
    """Which bags were given twice, and what is missing or damaged in them."""

    def __repr__(self) -> str:
        estimates = {each.name.replace(' ', '_'): speed_text(each.value) for each in self.content.estimates}
        return describe(
            f'Report on {counted(len(self.content.runs), "run")}: {self.output}',
            **estimates,
            predicted=speed_text(self.content.predicted),
            warnings='; '.join(self.warnings) or 'none',
        )


def report(
    bags: str | Path | Sequence[str | Path],
    output: str | Path,
    *,
    experiments: int | None = None,
    assumptions: AnyAssumptions = None,
    format: str | None = None,  # noqa: A002 - the option's name
    overwrite: bool = False,
    on_progress: Callable[[str], None] | None = None,
) -> Report:
    """Write a report on recorded runs: Tables 1 to 3 and Figures 2 to 6 beside 1997, the explanation, and a plan.

    Parameters
    ----------
    bags
        Folders of the runs, or folders that hold runs; the readings of one that is given twice count twice, and
        `.warnings` says so.
    output
        The file to write; its folder must be there.
    experiments
        Virtual ones to carry out on each preset, which say whether a bearing would have given the answer; where not
        given, 40 that were carried out beforehand are taken: they depend on nothing that is recorded.
    assumptions
        What is taken for granted: `Assumptions`, or those that are not the usual ones by their names.
    format
        html, md or pdf; by the suffix of `output` where not given, and html where that is none of them.
    overwrite
        A file that is there may be replaced.
    on_progress
        Called with what is being worked out.

    Returns
    -------
    Report
        The path and the numbers of the page.

    Raises
    ------
    KapitsaError
        A bag cannot be read, the runs do not belong together, the file is there already, or the `report` extra is not
        installed.

    Examples
    --------
    >>> import kapitsa_ros as kr
    >>> kr.report(['bags/run_01_2240rpm', 'bags/run_02_2640rpm'], 'report.html').output  # doctest: +SKIP
    PosixPath('report.html')

    """
    page = Path(output)
    check_output(page, overwrite=overwrite)
    write = report_format(page, format)
    from kapitsa_ros.reporting.report import gather, report_document  # noqa: PLC0415  # an extra, which is there

    progress = on_progress or (lambda _: None)
    paths = run_folders(Path(path) for path in ([bags] if isinstance(bags, str | Path) else bags))
    trials: dict[str, int] = {} if experiments is None else {'experiments': experiments}
    bags_read = runs_of(paths)
    content = gather(
        [bag.recorded for bag in bags_read],
        as_readings('1997'),
        as_assumptions(assumptions),
        on_progress=progress,
        **trials,
    )
    progress('drawing')
    with replacing(page) as draft:
        write(report_document(content), draft)
    return Report(output=page, content=content, warnings=(*repeats(paths), *dict.fromkeys(_defects(bags_read))))


def report_format(page: Path, kind: str | None) -> Callable[[Document, Path], None]:
    """Return what writes a report: by the format's name, else by the suffix of the file, else HTML.

    Raises
    ------
    OutputError
        There is no such format.
    MissingPackageError
        The `report` extra is not installed.

    """
    writers: Mapping[str, Callable[[Document, Path], None]]
    writers = import_of_extra('kapitsa_ros.reporting.report', 'a report', 'report').WRITERS
    suffix = page.suffix.removeprefix('.')
    chosen = kind or (suffix if suffix in writers else 'html')
    if chosen not in writers:
        raise OutputError(f'{OPTION}: no format: give one of {", ".join(writers)}', option='format', value=chosen)
    return writers[chosen]


def _defects(bags: Iterable[RunBag]) -> Iterator[str]:
    for bag in bags:
        yield from (f'{bag.path}: {defect}' for defect in bag.defects)
