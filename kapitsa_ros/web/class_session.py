"""One sitting of a class: start its server, print the links, end all runs when somebody interrupts."""

from __future__ import annotations

import asyncio
from contextlib import closing
from typing import TYPE_CHECKING

import click
import uvloop

from kapitsa_ros.rig.environment import use_slow_heartbeats
from kapitsa_ros.rig.fork_server_process import end_loading_server
from kapitsa_ros.web.access import Access
from kapitsa_ros.web.class_folder import ClassFolder, alone_in
from kapitsa_ros.web.class_server import class_application
from kapitsa_ros.web.classroom import Classroom
from kapitsa_ros.web.serving import Leaving, cancelled, listen, open_in_browser, serving

if TYPE_CHECKING:
    import socket
    from pathlib import Path

    from kapitsa_ros.configuration.class_settings import ClassSettings


def serve_class(settings: ClassSettings, folder: Path, *, host: str, port: int | None, open_page: bool) -> None:
    """Serve a class until somebody interrupts.

    Parameters
    ----------
    settings
        Of the class.
    folder
        For its files; a class that is there is gone on with.
    host, port
        Address that is listened on; without a port, the usual one or any that is free.
    open_page
        Whether to open the teacher's page, where there is a browser with a window.

    Raises
    ------
    UsageError
        The address cannot be listened on; the folder cannot be written, or holds something else.

    """
    use_slow_heartbeats()

    async def serve(listening: socket.socket) -> None:
        files = ClassFolder(folder, settings)
        access = Access(host, listening.getsockname()[1])  # a link to a class holds its code, a bench's its key
        leaving = Leaving()
        room = Classroom(settings, files)
        teacher = access.link('teacher', token=files.token)
        asked_to_leave = asyncio.create_task(leaving.wait())
        try:
            async with serving(class_application(room, access), listening) as server:
                click.echo(f'class: {access.link("", join=files.join_code)}')
                click.echo(f'teacher: {teacher}')
                click.echo(f'{"gone on with" if files.continued else "begun"} in {folder}; code {files.join_code}')
                if open_page:
                    await open_in_browser(teacher)
                await asyncio.wait({server, asked_to_leave}, return_when=asyncio.FIRST_COMPLETED)
                end_loading_server()
                await room.end()
        finally:
            await cancelled(asked_to_leave)
        if not leaving.hung_up:
            handed_in = sum(bool(bench.hand_ins) for bench in room.benches)
            click.echo(f'{handed_in} of {len(room.benches)} have handed in; books and runs are in {folder}')

    with alone_in(folder), closing(listen(host, port)) as listening:
        uvloop.run(serve(listening))
