"""`kapitsa replay`."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import click

from kapitsa_ros.cli.options import RATE, bags_argument, composed_option, json_option
from kapitsa_ros.cli.replay_keys import replay_keys
from kapitsa_ros.cli.server_options import NAMES, server_options
from kapitsa_ros.cli.show_result import show_result
from kapitsa_ros.cli.warnings_of_bags import warn, warn_of_defects, warn_of_repeats
from kapitsa_ros.configuration.errors import ConfigurationError
from kapitsa_ros.configuration.playback_parameters import LONGEST, PlaybackParameters
from kapitsa_ros.errors import OPTION
from kapitsa_ros.extras import import_of_extra
from kapitsa_ros.recording.naming import repeats
from kapitsa_ros.rig.errors import UsageError

if TYPE_CHECKING:
    from pathlib import Path

_FASTEST = 32.0
"""Pace of a page: what has no end could not be seen."""
_PLACE = click.FloatRange(0.0, LONGEST)


@click.command()
@bags_argument
@click.option(
    '--rate',
    type=RATE,
    default=None,
    help='simulated over wall seconds; 0: as fast as it can  [default: 0, in a loop 1]',
)
@click.option(
    '--start', '--start-offset', 'start', type=_PLACE, default=0.0, show_default=True, help='where to begin, s'
)
@click.option('--end', type=_PLACE, default=None, help='where to end, s  [default: the end]')
@click.option('--loop', is_flag=True, help='begin again at the end, until Ctrl-C')
@click.option('--start-paused', is_flag=True, help='wait for the service player/resume, or the space bar')
@composed_option
@click.option('--web', is_flag=True, help='in a browser, without the graph: prints the link, and serves until Ctrl-C')
@server_options('of --web: ')
@json_option
@click.pass_context
def replay(
    context: click.Context,
    *,
    bags: tuple[Path, ...],
    rate: float | None,
    start: float,
    end: float | None,
    loop: bool,
    start_paused: bool,
    composed: bool,
    web: bool,
    host: str,
    port: int | None,
    open_page: bool,
    as_json: bool,
) -> None:
    """Play recorded runs through the graph; the analyser there analyses them as they come.

    Places are seconds of the runs laid end to end. The analyser is given all from the beginning to the end of the part
    that is played, once; viewers see that part. In a terminal, space pauses and resumes, → makes one step, ↑ and ↓
    change the rate by 10 %.

    With --web, a page draws the rig as the bench does, from what was recorded alone: it can be paused, stepped, slowed
    down and moved to any place, with a lamp of its own, and the fit and the report of these runs beside it.
    """
    if web:
        if as_json or end is not None:
            raise UsageError(f'{OPTION}: a page shows it all', option='json' if as_json else 'end')
        beginning = {
            'start': start,
            'rate': 1.0 if rate is None else rate or _FASTEST,
            'paused': start_paused,
            'loop': loop,
        }
        _serve(bags, beginning, host=host, port=port, open_page=open_page)
        return
    _refuse_idle_options(context)
    from kapitsa_ros.cli.foreign_output import foreign_output_on_stderr  # noqa: PLC0415
    from kapitsa_ros.cli.node_server import node_server  # noqa: PLC0415
    from kapitsa_ros.cli.progress import shown_progress  # noqa: PLC0415
    from kapitsa_ros.recording.reader import runs_of  # noqa: PLC0415
    from kapitsa_ros.rig.session import replay_bags  # noqa: PLC0415  # rclpy takes its time
    from kapitsa_ros.rig.setup import Replay  # noqa: PLC0415

    try:
        part = PlaybackParameters(start=start, end=LONGEST if end is None else end)
    except ConfigurationError as error:
        raise click.UsageError(str(error)) from error
    rate = float(loop) if rate is None else rate
    warn_of_repeats(bags)
    how = Replay(rate=rate, part=part, composed=composed, loop=loop, start_paused=start_paused)

    def show(values: dict[str, Any]) -> None:
        warn_of_defects(values['runs'])
        show_result(values, runs_of(bags[:1])[0].run.plant, as_json=as_json)
        if 'played_s' in values and not as_json:
            begin, finish = values['played_s']
            click.echo(f'Played from {begin:g} to {finish:g} s; the analysis is of all that was recorded until then.')

    with node_server(), shown_progress(len(bags)) as on_progress, foreign_output_on_stderr() as own_output:

        def show_early(values: dict[str, Any]) -> None:
            with own_output():
                show(values)

        steered = partial(replay_keys, rate=rate)
        values = replay_bags(bags, how, on_progress, show_early if loop else None, steered)
    if not loop:
        show(values)


def _serve(bags: tuple[Path, ...], beginning: dict[str, Any], **where: Any) -> None:
    session = import_of_extra('kapitsa_ros.web.replay_session', 'a replay in a browser', 'web')
    warn_of_repeats(bags)
    session.serve_replay(bags, repeats(bags), beginning, warn, **where)


def _refuse_idle_options(context: click.Context) -> None:
    """Refuse options that would change nothing."""
    for name in NAMES:
        if context.get_parameter_source(name) is click.core.ParameterSource.COMMANDLINE:
            raise UsageError(f'{OPTION}: is of --web', option=name.partition('_')[0])
