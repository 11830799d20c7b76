"""One sitting of a server: it listens, serves its pages until a signal comes, and closes them."""

from __future__ import annotations

import asyncio
import os
import signal
import socket
import webbrowser
from contextlib import asynccontextmanager, contextmanager, suppress
from typing import TYPE_CHECKING

import uvicorn

from kapitsa_ros.rig.errors import UsageError
from kapitsa_ros.web.protocol import LARGEST_FRAME

if TYPE_CHECKING:
    from collections.abc import AsyncIterator, Iterator

    from starlette.types import ASGIApp

PORT = 8097
"""Where pages are looked for first."""
_GRACE = 2
"""Seconds that pages are given to close."""
_MOST_LINKS = 256
"""At a time."""


def listen(host: str, port: int | None) -> socket.socket:
    """Return a socket that listens; without a port, on the usual one or any that is free.

    Raises
    ------
    UsageError
        The address cannot be listened on.

    """
    family = socket.AF_INET6 if ':' in host else socket.AF_INET
    wanted = [PORT, 0] if port is None else [port]
    for each in wanted:
        try:
            return socket.create_server((host, each), family=family)
        except OSError as error:
            if each == wanted[-1]:
                raise UsageError(f'{host}, port {each}: cannot be listened on ({error.strerror or error})') from error
    raise AssertionError


async def open_in_browser(url: str) -> None:
    """Open a page where there is a browser with a window."""
    if os.environ.get('DISPLAY') or os.environ.get('WAYLAND_DISPLAY'):
        await asyncio.to_thread(webbrowser.open, url)


class Leaving:
    """A signal that asks to leave: awaited once a server runs."""

    def __init__(self) -> None:
        self._left = asyncio.Event()
        self._heard: set[int] = set()
        loop = asyncio.get_running_loop()
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            loop.add_signal_handler(number, self._leave, number)

    @property
    def hung_up(self) -> bool:
        """Whether the terminal was closed, and nobody reads what is printed."""
        return signal.SIGHUP in self._heard

    async def wait(self) -> None:
        """Wait until a signal comes."""
        await self._left.wait()

    def _leave(self, number: int) -> None:
        self._heard.add(number)
        self._left.set()


@asynccontextmanager
async def serving(app: ASGIApp, listening: socket.socket) -> AsyncIterator[asyncio.Task[None]]:
    """Serve while the context lasts; gives the task, which ends where the server cannot go on."""
    server = _Server(
        uvicorn.Config(
            app,
            log_level='error',
            lifespan='off',
            ws_max_size=LARGEST_FRAME,
            ws_max_queue=16,
            ws_per_message_deflate=False,
            limit_concurrency=_MOST_LINKS,
            timeout_graceful_shutdown=_GRACE,
            server_header=False,
        )
    )
    task = asyncio.create_task(server.serve(sockets=[listening]))
    try:
        yield task
    finally:
        server.should_exit = True
        await task


async def cancelled(*tasks: asyncio.Task[None]) -> None:
    """Cancel tasks, and wait for their end."""
    for task in tasks:
        task.cancel()
        with suppress(asyncio.CancelledError):
            await task


class _Server(uvicorn.Server):
    """A server that leaves signals to whoever runs it."""

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        yield
