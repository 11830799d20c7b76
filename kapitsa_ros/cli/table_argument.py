"""The argument TABLE: a CSV file, or the name of a shipped one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from kapitsa_ros.configuration.tables import TimingTable, load_timings

if TYPE_CHECKING:
    from collections.abc import Callable


class _Table(click.ParamType):  # type: ignore[type-arg]
    name = 'table'

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> TimingTable:  # noqa: ARG002
        return value if isinstance(value, TimingTable) else load_timings(value)


def table_argument(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the argument TABLE (by default the one of 1997); the command gets `table`."""
    return click.argument('table', metavar='[TABLE]', type=_Table(), default='1997')(command)
