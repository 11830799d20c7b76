"""`kapitsa serve`."""

from __future__ import annotations

from pathlib import Path

import click

from kapitsa_ros.cli.node_server import node_server
from kapitsa_ros.cli.server_options import server_options
from kapitsa_ros.configuration.class_settings import load_class
from kapitsa_ros.extras import import_of_extra


@click.command()
@click.option(
    '--class',
    'file',
    type=click.Path(path_type=Path),
    required=True,
    help='YAML file of the class: benches, seed, and what the rods are drawn from',
)
@click.option(
    '--bags',
    type=click.Path(path_type=Path),
    help='folder for books, runs and hand-ins; a class that is there goes on  [default: named like the file]',
)
@server_options()
def serve(*, file: Path, bags: Path | None, host: str, port: int | None, open_page: bool) -> None:
    """Serve a class: a bench for each student, in a browser, with a rod of its own that is sealed.

    Prints the link for students, which holds the code by which they join, then that of the teacher's page, and serves
    until Ctrl-C. A rig starts when its student comes, and stands still while nobody looks. Started again with the same
    file, it goes on with what is in the folder, however it was ended.
    """
    settings = load_class(file)
    with node_server(loads_first=False):  # what nodes need is loaded beside what pages need
        session = import_of_extra('kapitsa_ros.web.class_session', 'a class', 'web')
        session.serve_class(settings, bags or Path(file.stem), host=host, port=port, open_page=open_page)
