"""`figures`: Figures 2 to 6 of the report, recomputed."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from kapitsa_ros._api.inputs import as_plant, as_readings
from kapitsa_ros._api.result import describe, plant_text
from kapitsa_ros._api.result import figures as drawing
from kapitsa_ros.errors import OPTION, OutputError
from kapitsa_ros.output_file import check_output, replacing
from kapitsa_ros.physics.limits import check_forcing
from kapitsa_ros.quantities import to_si

if TYPE_CHECKING:
    from collections.abc import Callable

    from kapitsa_ros._api.inputs import AnyPlant, AnyReadings
    from kapitsa_ros.physics.plant import Plant
    from kapitsa_ros.quantities import AnyQuantity


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Figures:
    """Figures 2 to 6 that were written."""

    plant: Plant
    files: tuple[Path, ...]

    def __repr__(self) -> str:
        return describe(f'Figures 2 to 6: {plant_text(self.plant)}', files=', '.join(map(str, self.files)))


def figures(
    plant: AnyPlant = None,
    output: str | Path = 'figures',
    *,
    speed: AnyQuantity = '2500 rpm',
    readings: AnyReadings = '1997',
    format: str | None = None,  # noqa: A002 - the option's name
    overwrite: bool = False,
    on_progress: Callable[[str], None] = lambda _: None,
) -> Figures:
    """Draw Figures 2 to 6 of the report: the same bytes whatever a matplotlibrc says.

    Parameters
    ----------
    plant
        A `Plant`, or a preset by its name or path; the ideal rod of the report where not given.
    output
        A folder, which is made where it is not there; or a file, as in `'drawn/figure.svg'`: the figures' numbers are
        added to its name.
    speed
        ω of Figures 4 and 5, rad/s, or with a unit.
    readings
        What was measured: a table, by its name or path, or its columns (see `reduce`).
    format
        png, svg or pdf; by the suffix of `output` where not given, and png where that is none of them.
    overwrite
        Files that are there may be replaced.
    on_progress
        Called with what is being done.

    Returns
    -------
    Figures
        With the files, in the order of the figures.

    Raises
    ------
    KapitsaError
        An input cannot be used, a file cannot be written or is there already, or the `report` extra is not installed.

    Examples
    --------
    >>> import kapitsa_ros as kr
    >>> kr.figures('ideal', 'drawn', format='svg').files[0]  # doctest: +SKIP
    PosixPath('drawn/figure_2.svg')

    """
    draw = drawing()
    target = Path(output)
    suffix = '' if target.is_dir() else target.suffix.removeprefix('.')
    named = suffix in draw.FORMATS
    kind = format or (suffix if named else 'png')
    if kind not in draw.FORMATS:
        raise OutputError(f'{OPTION}: no format: give one of {", ".join(draw.FORMATS)}', option='format', value=kind)
    folder, stem = (target.parent, target.stem) if named else (target, 'figure')
    _check_folder(folder)
    files = {number: folder / f'{stem}_{number}.{kind}' for number in draw.FIGURES}
    if folder.is_dir():
        for file in files.values():
            check_output(file, overwrite=overwrite)
    forcing = to_si('speed', speed, 'rad/s')
    check_forcing(forcing)
    rod, measured = as_plant(plant), as_readings(readings)
    on_progress('drawing Figures 2 to 6')
    drawn = draw.report_figures(rod, forcing, measured)
    folder.mkdir(parents=True, exist_ok=True)
    for number, figure in drawn.items():
        on_progress(f'writing Figure {number}')
        with replacing(files[number]) as draft:
            draw.save(figure, draft, kind)
    return Figures(plant=rod, files=tuple(files.values()))


def _check_folder(folder: Path) -> None:
    above = next(each for each in (folder, *folder.absolute().parents) if each.exists())
    if not above.is_dir() or not os.access(above, os.W_OK | os.X_OK):
        raise OutputError(
            f'{OPTION}: cannot be made; give a folder you can write to', option='output', value=str(folder)
        )
