"""The command line: `kapitsa COMMAND`."""

from __future__ import annotations

import errno
import os
import sys
from importlib import import_module
from pkgutil import iter_modules
from typing import NoReturn

import click

from kapitsa_ros import __version__
from kapitsa_ros.cli import commands
from kapitsa_ros.cli.library_variables import check_library_variables
from kapitsa_ros.cli.node_server import OWN_PROCESS
from kapitsa_ros.cli.screen_width import forget_useless_width
from kapitsa_ros.cli.signals import Interrupt, forget_interrupts, interrupt_on_signals
from kapitsa_ros.cli.transliteration import showable, write_out_unknown_signs
from kapitsa_ros.docstrings import docstring_of
from kapitsa_ros.errors import FAILED, WRONG_INPUT, KapitsaError, shorten
from kapitsa_ros.standard_streams import keep_streams_open


class _Commands(click.Group):
    """Imports a command when it is run: theory should not wait for ROS."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002
        return sorted(module.name for module in iter_modules(commands.__path__))

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in self.list_commands(ctx):
            return None
        command: click.Command = getattr(import_module(f'{commands.__name__}.{cmd_name}'), cmd_name)
        _describe(command)
        return command


def _describe(command: click.Command) -> None:
    """Give a command the help that it has not where Python has left out docstrings."""
    if command.help is None and command.callback is not None:
        command.help = docstring_of(command.callback)
    for each in command.commands.values() if isinstance(command, click.Group) else ():
        _describe(each)


@click.group(cls=_Commands, no_args_is_help=False, context_settings={'help_option_names': ['-h', '--help']})
@click.version_option(__version__, prog_name='kapitsa')
def kapitsa() -> None:
    """Kapitsa's inverted pendulum on a jigsaw: theory, simulation, and the laboratory of 1997 as a ROS 2 graph."""


_describe(kapitsa)

# The matrices here are small: threads would spend more than they save, and sums would follow the number of cores.
os.environ.setdefault('OPENBLAS_NUM_THREADS', '1')


_MENDS = {
    errno.EAGAIN: ': allow more processes and threads, with ulimit -u',
    errno.EDQUOT: ': make room there',
    errno.EFBIG: ': allow larger files, with ulimit -f',
    errno.EMFILE: ': allow more, with ulimit -n',
    errno.ENOSPC: ': make room there',
    errno.EROFS: ': give a place that can be written',
}
"""What to do where the system refuses something."""
_NO_THREAD = "can't start new thread"
"""As Python says it, by no error of its own."""


def main() -> None:
    """Run the command line: one line on stderr and status 2 for wrong input, 1 for work that failed."""
    keep_streams_open()
    if sys.stdout is None:  # what a command finds would be lost without a word
        _leave('stdout is closed: redirect it, to /dev/null if nothing shall be shown', WRONG_INPUT)
    interrupt_on_signals()
    write_out_unknown_signs()
    forget_useless_width()
    try:
        check_library_variables()
        kapitsa.main(prog_name='kapitsa', standalone_mode=False, obj=OWN_PROCESS)
    except click.UsageError as error:
        where = error.ctx.command_path if error.ctx is not None else 'kapitsa'
        _leave(f'{error.format_message()} (see {where} --help)', WRONG_INPUT)
    except click.ClickException as error:
        _leave(error.format_message(), WRONG_INPUT)
    except KapitsaError as error:
        _leave(str(error), error.exit_status)
    except click.exceptions.Exit as leave:
        sys.exit(leave.exit_code)
    except (OSError, RuntimeError, MemoryError) as error:
        _leave_refused(error)
    except Interrupt as interrupt:
        _leave('interrupted', interrupt.status)
    finally:
        forget_interrupts()


def _leave_refused(error: OSError | RuntimeError | MemoryError) -> None:
    """End with a line on what the system has refused; a RuntimeError of another kind is a defect."""
    if isinstance(error, BrokenPipeError):
        # Whoever read the output has left; the interpreter would complain once more when it flushes.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(FAILED)
    if isinstance(error, OSError):
        _leave(f'{error}{_mend(error)}', FAILED)
    if isinstance(error, MemoryError):
        _leave(f'{error or "the memory is used up"}: ask for less at once (a shorter run, fewer samples)', FAILED)
    if str(error) != _NO_THREAD:
        raise error
    _leave(f'{error}{_MENDS[errno.EAGAIN]}', FAILED)


def _mend(error: OSError) -> str:
    """Return what to do where the system does not say of what it complains."""
    if isinstance(error, BlockingIOError) and hasattr(error, 'characters_written'):  # of a stream, not of a process
        return ''
    if error.errno in _MENDS:
        return _MENDS[error.errno]
    if error.errno == errno.ENOENT and error.filename is None:
        try:
            os.getcwd()  # noqa: PTH109  # that it can be had is what is asked
        except FileNotFoundError:
            return ': the current folder is gone, change to another'
    return ''


def _leave(message: str, status: int) -> NoReturn:
    line = showable(f'kapitsa: error: {message}', sys.stderr.encoding)  # what is written out is longer
    print(shorten(line), file=sys.stderr)
    sys.exit(status)
