"""One sitting at the bench in a browser: start rig and server, print the link, list the files that were written."""

from __future__ import annotations

import asyncio
import os
import signal
import socket
import webbrowser
from contextlib import closing, contextmanager, suppress
from typing import TYPE_CHECKING

import click
import uvicorn

from kapitsa_ros.bench.bench_files import print_what_is_left, refuse_old_runs
from kapitsa_ros.rig.errors import UsageError
from kapitsa_ros.rig.preflight import make_writable
from kapitsa_ros.web.access import Access
from kapitsa_ros.web.protocol import LARGEST_FRAME
from kapitsa_ros.web.server import application
from kapitsa_ros.web.web_bench import WebBench

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from kapitsa_ros.instruments.settings import Instruments
    from kapitsa_ros.physics.plant import Plant

PORT = 8097
"""Where the bench is looked for first."""
_GRACE = 2
"""Seconds that pages are given to close."""


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

    async def serve(listening: socket.socket) -> None:
        bench = WebBench(plant, instruments, seed, rate, bags, table, composed=composed)
        make_writable(bags)
        access = Access.of(host, listening.getsockname()[1])
        click.echo(f'bench: {access.url}')
        if open_page and (os.environ.get('DISPLAY') or os.environ.get('WAYLAND_DISPLAY')):
            await asyncio.to_thread(webbrowser.open, access.url)
        if await _serve(bench, access, listening):
            print_what_is_left(bench.folders, bench.state.notebook)

    with closing(_listen(host, port)) as listening:
        asyncio.run(serve(listening))


async def _serve(bench: WebBench, access: Access, listening: socket.socket) -> bool:
    """Serve until a signal comes, or the rig cannot be started; return whether somebody still listens."""
    left = asyncio.Event()
    heard: set[int] = set()

    def leave(number: int) -> None:
        heard.add(number)
        left.set()

    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        loop.add_signal_handler(number, leave, number)
    server = _Server(
        uvicorn.Config(
            application(bench, access),
            log_level='error',
            lifespan='off',
            ws_max_size=LARGEST_FRAME,
            ws_max_queue=16,
            ws_per_message_deflate=False,
            limit_concurrency=64,
            timeout_graceful_shutdown=_GRACE,
            server_header=False,
        )
    )
    serving = asyncio.create_task(server.serve(sockets=[listening]))
    telling = asyncio.create_task(bench.tell_pages())
    leaving = asyncio.create_task(left.wait())
    starting = asyncio.create_task(bench.start())
    try:
        await asyncio.wait({starting, leaving}, return_when=asyncio.FIRST_COMPLETED)
        await starting
        await asyncio.wait({serving, leaving}, return_when=asyncio.FIRST_COMPLETED)
    finally:
        await bench.end()
        server.should_exit = True
        await serving
        for task in (telling, leaving):
            task.cancel()
            with suppress(asyncio.CancelledError):
                await task
    return signal.SIGHUP not in heard


class _Server(uvicorn.Server):
    """A server that leaves signals to whoever runs it."""

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield


def _listen(host: str, port: int | None) -> socket.socket:
    family = socket.AF_INET6 if ':' in host else socket.AF_INET
    wanted = [PORT, 0] if port is None else [port]
    for each in wanted:
        try:
            return socket.create_server((host, each), family=family)
        except OSError as error:
            if each == wanted[-1]:
                raise UsageError(f'{host}, port {each}: cannot be listened on ({error.strerror or error})') from error
    raise AssertionError
