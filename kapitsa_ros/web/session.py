"""One sitting at the bench in a browser: start rig and server, print the link, list the files that were written."""

from __future__ import annotations

import asyncio
from contextlib import closing, suppress
from typing import TYPE_CHECKING

import click
import uvloop

from kapitsa_ros.bench.bench_files import print_what_is_left, refuse_old_runs
from kapitsa_ros.bench.notebook import Notebook
from kapitsa_ros.rig.environment import use_slow_heartbeats
from kapitsa_ros.rig.errors import RigError
from kapitsa_ros.rig.fork_server_process import end_loading_server
from kapitsa_ros.rig.preflight import make_writable
from kapitsa_ros.web.access import Access
from kapitsa_ros.web.bench_setup import BenchSetup
from kapitsa_ros.web.server import application
from kapitsa_ros.web.serving import Leaving, cancelled, listen, open_in_browser, serving
from kapitsa_ros.web.web_bench import WebBench

if TYPE_CHECKING:
    import socket
    from pathlib import Path

    from kapitsa_ros.instruments.settings import Instruments
    from kapitsa_ros.physics.plant import Plant


def serve_bench(  # noqa: PLR0917  # the command's options
    plant: Plant,
    instruments: Instruments,
    seed: int,
    rate: float,
    bags: Path,
    table: Path,
    *,
    host: str,
    port: int | None,
    open_page: bool,
    composed: bool = False,
) -> None:
    """Start a rig and a page in front of it, and serve until somebody interrupts.

    Parameters
    ----------
    plant, instruments, seed, rate, bags, table
        As of the bench in a terminal.
    host, port
        Address that is listened on; without a port, the usual one or any that is free.
    open_page
        Whether to open the page, where there is a browser with a window.
    composed
        Whether the nodes of the rig share one process.

    Raises
    ------
    UsageError
        The address cannot be listened on; the folder cannot be written; the table is there already.
    BagError
        The folder holds runs of another sitting.
    RigError
        The rig cannot be started.

    """
    refuse_old_runs(bags)
    use_slow_heartbeats()

    async def serve(listening: socket.socket) -> None:
        setup = BenchSetup(
            plant=plant,
            instruments=instruments,
            seed=seed,
            rate=rate,
            bags=bags,
            shown=plant,
            composed=composed,
        )
        bench = WebBench(setup, Notebook(table))
        make_writable(bags)
        access = Access.of(host, listening.getsockname()[1])
        leaving = Leaving()  # before the link is printed: who reads it may interrupt
        click.echo(f'bench: {access.url}')
        if open_page:
            await open_in_browser(access.url)
        await _serve(bench, access, listening, leaving)
        if not leaving.hung_up:
            print_what_is_left(bench.folders, bench.state.notebook, plant)

    with closing(listen(host, port)) as listening:
        uvloop.run(serve(listening))


async def _serve(bench: WebBench, access: Access, listening: socket.socket, leaving: Leaving) -> None:
    """Serve until a signal comes, or the rig cannot be started."""
    async with serving(application(bench, access), listening) as server:
        telling = asyncio.create_task(bench.tell_pages())
        asked_to_leave = asyncio.create_task(leaving.wait())
        starting = asyncio.create_task(bench.start())
        try:
            await asyncio.wait({starting, asked_to_leave}, return_when=asyncio.FIRST_COMPLETED)
            if not starting.done() and end_loading_server():
                with suppress(RigError):
                    await starting
                return
            await starting
            await asyncio.wait({server, asked_to_leave}, return_when=asyncio.FIRST_COMPLETED)
        finally:
            await bench.end()
            await cancelled(telling, asked_to_leave)
