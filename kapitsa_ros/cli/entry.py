"""The script `kapitsa`: it stands apart from the command line, which takes a while to load."""

from __future__ import annotations

import signal
import sys

from kapitsa_ros.address_space import OF_A_COMMAND, AddressSpaceError, refuse_small_address_space


def main() -> None:
    """Run the command line; until it is loaded, Ctrl-C ends the process at once: there is nothing to stop."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    signal.signal(signal.SIGCHLD, signal.SIG_DFL)  # whoever started this may have it ignored: no child's end is told
    try:
        refuse_small_address_space(OF_A_COMMAND)
    except AddressSpaceError as error:
        print(f'kapitsa: error: {error}', file=sys.stderr)
        sys.exit(error.exit_status)
    from kapitsa_ros.cli.main import main as run  # noqa: PLC0415  # not before the signals and the memory are looked at

    run()
