"""The argument TABLE: a CSV file, or the name of a shipped one."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from kapitsa_ros.analysis.table import Readings, read_table
from kapitsa_ros.resources import resource_path

if TYPE_CHECKING:
    from collections.abc import Callable


class _Table(click.ParamType):  # type: ignore[type-arg]
    name = 'table'

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Readings:  # noqa: ARG002
        if isinstance(value, Readings):
            return value
        path = Path(value)
        shipped = resource_path('config', 'tables', f'{path.stem}.csv')
        named = path.parent == Path() and not path.exists() and shipped.is_file()
        return read_table(shipped if named else path)


def table_argument(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the argument TABLE (by default the one of 1997); the command gets `readings`."""
    return click.argument('readings', metavar='[TABLE]', type=_Table(), default='1997')(command)
