"""Options of commands that serve pages."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from collections.abc import Callable

NAMES = ('host', 'port', 'open_page')
"""By which the command gets them."""


def server_options(of: str = '') -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Add --host, --port and --open; `of` stands before their help."""

    def add(command: Callable[..., Any]) -> Callable[..., Any]:
        command = click.option(
            '--open/--no-open', 'open_page', default=True, help=f'{of}open the page, where there is a display'
        )(command)
        command = click.option(
            '--port',
            type=click.IntRange(0, 65535),
            help=f'{of}port  [default: 8097, or any that is free]',
            metavar='NUMBER',
        )(command)
        return click.option('--host', default='127.0.0.1', show_default=True, help=f'{of}address that is listened on')(
            command
        )

    return add
