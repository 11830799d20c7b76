"""A signal that comes where nothing can be raised interrupts the command all the same."""

import signal
import subprocess
import sys

import pytest

BEGIN = """
import ctypes, signal, sys
from kapitsa_ros.cli.signals import Interrupt, forget_interrupts, interrupt_on_signals
interrupt_on_signals()
def hear():
    signal.raise_signal(signal.SIGTERM)
class Destroyed:
    def __del__(self):
        hear()
try:
    {where}
    signal.pause()  # until the look after what was lost
    print('was not interrupted')
except Interrupt as interrupt:
    signal.raise_signal(signal.SIGALRM)  # the next look: it is not raised again while somebody stops the command
    forget_interrupts()
    sys.exit(interrupt.status)
"""


@pytest.mark.parametrize(
    'where',
    ['ctypes.CFUNCTYPE(None)(hear)()', 'Destroyed()', 'try: hear()\n    except BaseException: pass', 'hear()'],
    ids=['callback from C', 'destructor', 'caught by a library', 'plain'],
)
def test_an_interrupt_is_not_lost(where: str) -> None:
    done = subprocess.run(
        [sys.executable, '-c', BEGIN.format(where=where)],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (128 + signal.SIGTERM, '', '')


def test_what_else_goes_wrong_in_a_destructor_is_still_shown() -> None:
    program = (
        'from kapitsa_ros.cli.signals import interrupt_on_signals\n'
        'interrupt_on_signals()\n'
        'class Destroyed:\n'
        '    def __del__(self): raise ValueError("shown")\n'
        'Destroyed()'
    )
    done = subprocess.run([sys.executable, '-c', program], capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0
    assert 'ValueError: shown' in done.stderr
