"""What people read on stdout: sentences and tables that lose nothing on a narrow terminal or one without Greek."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.measure import Measurement

from kapitsa_ros.cli.transliteration import showable

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rich.console import RenderableType
    from rich.table import Table
    from rich.text import Text

_ANY_WIDTH = 10_000
_PADDING = 2  # signs, of a column


class _Terminal(Console):
    """Writes out signs that the encoding lacks before anything is aligned, as what is written is longer."""

    def render_str(self, text: str, **kwargs: Any) -> Text:
        return super().render_str(showable(text, self.encoding), **kwargs)


def say(sentences: Iterable[str]) -> None:
    """Print sentences, a paragraph each, broken between words."""
    console = _Terminal()
    for sentence in sentences:
        console.print(sentence, markup=False, highlight=False)


def show_table(table: Table) -> None:
    """Print a table; where its longest words do not stand side by side, a line for each cell."""
    console = _Terminal()
    ranges = [_range(console, [column.header, *column.cells]) for column in table.columns]
    needed = sum(least for least, _ in ranges)
    room = console.width - len(ranges) - 1  # a line beside each column
    if needed > room:
        _show_cells(console, table)
        return
    if needed > room - _PADDING * len(ranges):
        table.padding = 0
    else:
        room -= _PADDING * len(ranges)
    if sum(most for _, most in ranges) > room:
        spare = room - sum(least for least, _ in ranges)
        wanted = sum(most - least for least, most in ranges)
        for column, (least, most) in zip(table.columns, ranges, strict=True):
            column.width = least + spare * (most - least) // wanted
    console.print(table)


def _range(console: Console, cells: Iterable[RenderableType]) -> tuple[int, int]:
    """Return the longest word and the longest line of a column."""
    measured = [Measurement.get(console, console.options.update(width=_ANY_WIDTH), cell) for cell in cells]
    return max(each.minimum for each in measured), max(each.maximum for each in measured)


def _show_cells(console: Console, table: Table) -> None:
    if table.title:
        console.print(table.title, style='italic')
    headings = [str(column.header) for column in table.columns]
    for row in zip(*(column.cells for column in table.columns), strict=True):
        first, *others = (str(cell) for cell in row)
        console.print(f'{headings[0]} {first}'.strip(), style='bold', markup=False, highlight=False)
        for heading, cell in zip(headings[1:], others, strict=True):
            if cell:
                console.print(f'  {heading}: {cell}', markup=False, highlight=False)
