"""A class as tables: how each bench stands, and every line of every book."""

from __future__ import annotations

import csv
import io
from typing import TYPE_CHECKING, Any

from kapitsa_ros.bench.notebook import WrittenRow

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from kapitsa_ros.web.classroom import Classroom

_FORMULA = ('=', '+', '-', '@', '\t', '\r')
"""By which spreadsheets know what is to be worked out; a name is not."""


def class_csv(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return a line a bench."""
    return _csv(list(rows[0]), [list(row.values()) for row in rows])


def books_csv(room: Classroom) -> str:
    """Return the lines of all books, those struck out and the remarks too."""
    names = ['bench', 'name', 'line', 'run', 'forcing_rpm', 'period_s', 'swings', 'display_s', 'struck', 'note']
    lines: list[list[Any]] = []
    for bench in room.benches:
        for number, line in enumerate(bench.state.notebook.lines, start=1):
            head = [bench.number, bench.record.name, number]
            if isinstance(line, WrittenRow):
                row = line.row
                read = [row.run, row.forcing_rpm, row.period_s, row.swings, row.display_s]
                lines.append([*head, *read, line.struck, None])
            else:
                lines.append([*head, *[None] * 6, line])
    return _csv(names, lines)


def _csv(names: Sequence[str], lines: Sequence[Sequence[Any]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator='\n')
    writer.writerow(names)
    writer.writerows([[_cell(value) for value in line] for line in lines])
    return text.getvalue()


def _cell(value: Any) -> Any:
    if value is None:
        return ''
    if isinstance(value, bool):
        return str(value).lower()
    return f"'{value}" if isinstance(value, str) and value.startswith(_FORMULA) else value
