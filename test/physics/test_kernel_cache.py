"""Compiled kernels are kept where the user can write, up to date and whole; nothing fails where none can be kept."""

import math
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

import kapitsa_ros
from kapitsa_ros.physics.kernels.series import expand, value_and_slope
from kapitsa_ros.physics.kernels.verlet import verlet

PACKAGE = Path(kapitsa_ros.__file__).parent
CALL = """
import sys
import numpy as np
from kapitsa_ros.physics.kernels.series import expand, value_and_slope
from kapitsa_ros.physics.kernels.verlet import verlet
out = np.empty((2, 2))
verlet(1.0, 1.0, 250.0, 0.0, 0.1, 1, out)
print('compiled' if 'numba' in sys.modules else 'found', out[0, 1])
"""


@pytest.fixture
def install() -> Iterator[Path]:
    """A copy of the package that can be read and not written."""
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / PACKAGE.name
        shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns('__pycache__'))
        for path in (Path(folder), copy, *copy.rglob('*')):
            path.chmod(0o555 if path.is_dir() else 0o444)
        yield Path(folder)
        for path in (Path(folder), copy, *copy.rglob('*')):
            path.chmod(0o755 if path.is_dir() else 0o644)


def call_kernel(install: Path, setting: str = ':', **environment: str) -> subprocess.CompletedProcess[str]:
    """Call a kernel as a user without a home; a shell may set something before."""
    command = ['/bin/sh', '-c', f'{setting} && exec "$@"', '-', sys.executable, '-c', CALL]
    if os.getuid() == 0:
        if shutil.which('setpriv') is None:
            pytest.skip('root can write everywhere, and there is no setpriv')
        command = ['setpriv', '--bounding-set=-dac_override', *command]
    env = {'PATH': os.environ['PATH'], 'HOME': '/proc/nonexistent', 'PYTHONPATH': str(install)} | environment
    return subprocess.run(command, env=env, cwd='/', capture_output=True, text=True, timeout=120, check=False)


def test_a_user_without_a_home_computes_and_is_told_once_how_to_keep_what_is_compiled(install: Path) -> None:
    done = call_kernel(install)
    assert done.returncode == 0, done.stderr
    how, angle = done.stdout.split()
    assert how == 'compiled'
    assert 0.05 < float(angle) < 0.2
    (line,) = done.stderr.splitlines()
    assert line.startswith('kapitsa: warning: ')
    assert 'NUMBA_CACHE_DIR' in line


def test_the_folder_that_the_user_names_keeps_what_is_compiled_until_any_kernel_changes(install: Path) -> None:
    with tempfile.TemporaryDirectory() as cache:
        Path(cache).chmod(0o777)
        runs = [call_kernel(install, NUMBA_CACHE_DIR=cache) for _ in range(2)]
        # Kernels are compiled into one another: a change of one makes what was compiled from the others stale.
        os.utime(install / PACKAGE.name / 'physics' / 'kernels' / 'series.py', ns=(1, 1))
        runs.append(call_kernel(install, NUMBA_CACHE_DIR=cache))
    assert [run.stderr for run in runs] == [''] * 3
    assert [run.stdout.split()[0] for run in runs] == ['compiled', 'found', 'compiled']
    assert len({run.stdout.split()[1] for run in runs}) == 1


DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    'emptied': lambda _: b'',
    'cut off': lambda kept: kept[: len(kept) // 2],
    'zeroed': lambda kept: bytes(len(kept)),
    'zeroed in the middle': lambda kept: kept[: len(kept) // 3] + bytes(len(kept) // 3) + kept[2 * (len(kept) // 3) :],
}
"""What a power cut makes of a file; in the middle of machine code nothing complains, but the processor."""


@pytest.mark.parametrize('damage', DAMAGES)
def test_what_cannot_be_loaded_is_compiled_again_and_kept(install: Path, damage: str) -> None:
    with tempfile.TemporaryDirectory() as cache:
        Path(cache).chmod(0o777)
        runs = [call_kernel(install, NUMBA_CACHE_DIR=cache)]
        [kept] = Path(cache).rglob('*.o')
        kept.write_bytes(DAMAGES[damage](kept.read_bytes()))
        runs += [call_kernel(install, NUMBA_CACHE_DIR=cache) for _ in range(2)]
    assert [run.stderr for run in runs] == [''] * 3
    assert [run.stdout.split()[0] for run in runs] == ['compiled', 'compiled', 'found']
    assert len({run.stdout.split()[1] for run in runs}) == 1


def test_what_the_disk_does_not_take_is_said_once_and_computed(install: Path) -> None:
    with tempfile.TemporaryDirectory() as cache:
        Path(cache).chmod(0o777)
        done = call_kernel(install, 'ulimit -f 4', NUMBA_CACHE_DIR=cache)
    assert done.returncode == 0, done.stderr
    (line,) = done.stderr.splitlines()
    assert line.startswith('kapitsa: warning: ')
    assert 'NUMBA_CACHE_DIR' in line


def test_what_is_compiled_by_other_rules_is_not_used_without_them(install: Path) -> None:
    """Its last digits are others, so that runs were no more what they had been."""
    with tempfile.TemporaryDirectory() as cache:
        Path(cache).chmod(0o777)
        rules = [{'NUMBA_OPT': '0'}, {}, {'NUMBA_OPT': '3'}]
        runs = [call_kernel(install, NUMBA_CACHE_DIR=cache, **rule) for rule in rules]
    assert [run.stdout.split()[0] for run in runs] == ['compiled', 'compiled', 'found']


ORDERS = (('half_trace', 'half_period'), ('half_period', 'half_trace'))
CALLS = """
import sys
import numpy as np
from kapitsa_ros.physics.kernels import mathieu
a, work = np.linspace(-0.9, 0.9, 50), np.empty(mathieu.WORK_SHAPE)
traces = np.empty((50, 50))
calls = {
    'half_trace': lambda: mathieu.half_trace(a, np.linspace(0.1, 4.0, 50), traces, work),
    'half_period': lambda: [mathieu.half_period(each, 2.5, work) for each in a.tolist()],
}
found = {name: calls[name]() for name in sys.argv[1].split()}
print(found['half_period'], traces.tobytes().hex())
"""


def test_a_process_that_compiles_a_kernel_gives_the_digits_of_one_that_loads_it(install: Path) -> None:
    """In Numba's own memory another copy of the common function was called where it had been compiled just before."""
    with tempfile.TemporaryDirectory() as cache:
        told = {
            subprocess.run(
                [sys.executable, '-c', CALLS, ' '.join(order)],
                env=os.environ | {'NUMBA_CACHE_DIR': str(Path(cache, folder)), 'PYTHONPATH': str(install)},
                capture_output=True, text=True, timeout=120, check=True,
            ).stdout
            for folder in ('one', 'other') for order in (ORDERS if folder == 'one' else ORDERS[::-1])
        }  # fmt: skip
    assert len(told) == 1


FORK = """
import logging, os, signal, threading  # logging does not bear to be loaded in the middle of a fork
import numpy as np
from kapitsa_ros.physics.kernels import mathieu, native_code, verlet

begun = threading.Event()
folders = native_code._folders
native_code._folders = lambda: begun.set() or folders()  # asked first of all
work = np.empty(mathieu.WORK_SHAPE)
loading = threading.Thread(target=lambda: mathieu.half_period(0.1, 0.5, work))
loading.start()
begun.wait()
if not os.fork():
    signal.alarm(60)
    verlet.verlet(1.0, 1.0, 250.0, 0.0, 0.1, 1, np.empty((2, 2)))
    os._exit(0)
print(os.waitstatus_to_exitcode(os.wait()[1]))
loading.join()
"""


def test_a_fork_waits_for_a_kernel_that_another_thread_is_loading(install: Path) -> None:
    """The child has no such thread, and would wait for it for ever."""
    with tempfile.TemporaryDirectory() as cache:
        done = subprocess.run(
            [sys.executable, '-W', 'ignore', '-c', FORK],
            env=os.environ | {'NUMBA_CACHE_DIR': cache, 'PYTHONPATH': str(install)},
            capture_output=True, text=True, timeout=120, check=False,
        )  # fmt: skip
    assert (done.returncode, done.stdout, done.stderr) == (0, '0\n', '')


def test_an_array_that_is_none_of_doubles_in_order_is_refused() -> None:
    out = np.empty((2, 4))
    verlet(1.0, 1.0, 250.0, 0.0, 0.1, 3, out)
    for wrong in (out[:, ::2], out.T, out.astype(np.float32), out.tolist(), np.frombuffer(bytes(64)).reshape(2, 4)):
        with pytest.raises(TypeError, match='give an array of doubles in C order that can be written'):
            verlet(1.0, 1.0, 250.0, 0.0, 0.1, 3, wrong)


def test_arguments_are_counted() -> None:
    """C takes what it is given."""
    given = (1.0, 1.0, 250.0, 0.0, 0.1, 1, np.empty((2, 2)))
    for wrong in (given[:-1], (*given, 7)):
        with pytest.raises(TypeError, match=f'verlet takes 7 arguments, not {len(wrong)}'):
            verlet(*wrong)
    with pytest.raises(TypeError):
        verlet(*given, out=given[-1])


def test_numbers_go_in_and_come_out_as_what_they_are() -> None:
    assert value_and_slope(np.array([1.0, 2.0, 3.0]), 2.0) == (17.0, 14.0)
    series = [np.zeros(3) for _ in range(5)]
    for linear, third in ((True, 0.5), (False, 0.5 * math.sin(1.0))):
        series[0][:], series[1][:] = (1.0, 0.0, 0.0), (1.0, 0.0, 0.0)
        expand(series[0], 0.0, 0.0, linear, *series[1:])
        assert series[1][2] == pytest.approx(third, rel=1e-14)
