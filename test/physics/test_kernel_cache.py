"""Compiled kernels are kept where the user can write, are up to date, and do without where nothing can be written."""

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

import kapitsa_ros

PACKAGE = Path(kapitsa_ros.__file__).parent
CALL = """
import numpy as np
from kapitsa_ros.physics.kernels.verlet import verlet
out = np.empty((2, 2))
verlet(1.0, 1.0, 250.0, 0.0, 0.1, 1, out)
print(sum(verlet.stats.cache_hits.values()), out[0, 1])
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


def call_kernel(install: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """Call a kernel as a user without a home."""
    command = [sys.executable, '-c', CALL]
    if os.getuid() == 0:
        if shutil.which('setpriv') is None:
            pytest.skip('root can write everywhere, and there is no setpriv')
        command = ['setpriv', '--bounding-set=-dac_override', *command]
    env = {'PATH': os.environ['PATH'], 'HOME': '/proc/nonexistent', 'PYTHONPATH': str(install)} | environment
    return subprocess.run(command, env=env, cwd='/', capture_output=True, text=True, timeout=120, check=False)


def test_a_user_without_a_home_computes_and_is_told_once_how_to_keep_what_is_compiled(install: Path) -> None:
    done = call_kernel(install)
    assert done.returncode == 0, done.stderr
    hits, angle = done.stdout.split()
    assert int(hits) == 0
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
    assert [int(run.stdout.split()[0]) for run in runs] == [0, 1, 0]
    assert len({run.stdout.split()[1] for run in runs}) == 1
