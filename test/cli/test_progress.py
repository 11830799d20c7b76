"""Long work is seen on a terminal, and nowhere else."""

import os
import pty
import subprocess
import sys
from pathlib import Path

import pytest

from kapitsa_ros.cli.progress import shown_progress

SIMULATE = ('simulate', '--speed', '2500', '--release', '0.12', '--duration', '2')
NAMED = 'kapitsa: compiling advance_cosine, once after an installation'


def on_terminal(*command: str, **environment: str) -> str:
    """Run a command whose stderr is a terminal, and return what it writes there."""
    ours, theirs = pty.openpty()
    with subprocess.Popen(
        [sys.executable, *command],
        stdout=subprocess.DEVNULL,
        stderr=theirs,
        env=os.environ | {'TERM': 'xterm'} | environment,
    ) as done:
        os.close(theirs)
        written = b''
        while True:
            try:
                part = os.read(ours, 4096)
            except OSError:  # so a terminal says that nobody writes any more
                break
            if not part:
                break
            written += part
    os.close(ours)
    assert done.returncode == 0, written
    return written.decode()


def test_what_is_compiled_is_said_once_and_only_on_a_terminal(tmp_path: Path) -> None:
    afresh = [{'NUMBA_OPT': '1', 'NUMBA_CACHE_DIR': str(tmp_path / folder)} for folder in 'AB']
    simulate = ('-c', 'import kapitsa_ros as kr; [kr.simulate(speed=250.0, release=0.1, duration=0.1) for _ in "12"]')
    said = on_terminal(*simulate, **afresh[0])
    assert said.count(NAMED) == 1
    assert said.count('compiling') == said.count('kapitsa: compiled in')
    assert 'advance_interval' not in said  # what is compiled into another
    done = subprocess.run(
        [sys.executable, *simulate], env=os.environ | afresh[1], capture_output=True, text=True, check=True
    )
    assert done.stderr == ''


def test_a_run_has_one_line_where_there_is_no_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    with shown_progress(2) as take:
        for run in ('1', '01', '2', '0', '3', '2'):
            take({'run': run, 'simulated_s': '0.5', 'realtime_factor': '2.0'})
    lines = capsys.readouterr().err.split('\n')
    assert [line for line in lines if line] == [
        'run 1 of 2: 0 s simulated, 2 times real time', 'run 2 of 2: 0 s simulated, 2 times real time'
    ]  # fmt: skip


def test_a_command_shows_on_a_terminal_what_it_is_at() -> None:
    assert 'following the rod for 2 s' in on_terminal('-m', 'kapitsa_ros', *SIMULATE)
