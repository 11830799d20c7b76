"""One sitting with recorded runs in a browser."""

from __future__ import annotations

import asyncio
from contextlib import closing
from typing import TYPE_CHECKING, Any

import click
import uvloop

from kapitsa_ros.web.access import Access
from kapitsa_ros.web.recorded_runs import RecordedRuns
from kapitsa_ros.web.replay_server import replay_application
from kapitsa_ros.web.serving import Leaving, cancelled, listen, open_in_browser, serving

if TYPE_CHECKING:
    import socket
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path


def serve_replay(
    bags: Sequence[Path],
    warnings: Sequence[str],
    beginning: Mapping[str, Any],
    warn: Callable[[str], None],
    *,
    host: str,
    port: int | None,
    open_page: bool,
) -> None:
    """Show recorded runs in a page until somebody interrupts.

    Parameters
    ----------
    bags
        Of the runs.
    warnings
        What is wrong with the bags together.
    beginning
        How the page is to begin: see `replay_application`.
    warn
        Called with each defect of the bags.
    host, port
        Address that is listened on; without a port, the usual one or any that is free.
    open_page
        Whether to open the page, where there is a browser with a window.

    Raises
    ------
    UsageError
        The address cannot be listened on.
    BagError
        One of the bags is none, or has no run of this rig in it.

    """
    runs = RecordedRuns(bags)
    for defect in runs.defects():
        warn(defect)

    async def serve(listening: socket.socket) -> None:
        access = Access.of(host, listening.getsockname()[1])
        leaving = Leaving()
        asked_to_leave = asyncio.create_task(leaving.wait())
        async with serving(replay_application(runs, bags, warnings, beginning, access), listening) as server:
            click.echo(f'replay: {access.url}')
            if open_page:
                await open_in_browser(access.url)
            await asyncio.wait({server, asked_to_leave}, return_when=asyncio.FIRST_COMPLETED)
        await cancelled(asked_to_leave)

    with closing(listen(host, port)) as listening:
        uvloop.run(serve(listening))
