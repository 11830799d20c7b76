"""The diffs of docs/extending.md do what it says."""

import json
import math
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SECTION = re.compile(r'^## (.+?)\n(.*?)(?=^## |\Z)', re.MULTILINE | re.DOTALL)
SECTIONS = dict(SECTION.findall((ROOT / 'docs' / 'extending.md').read_text(encoding='utf-8')))
DIFF = re.compile(r'^```diff\n(.*?)^```$', re.MULTILINE | re.DOTALL)

Python = Callable[..., str]
READ = """
import json, sys
from pathlib import Path
from kapitsa_ros.recording.reader import RunBag
run = RunBag(Path(sys.argv[1])).run
print(json.dumps([reading.speed for reading in run.readings['tachometer']]))
"""


@pytest.fixture
def extended(request: pytest.FixtureRequest, tmp_path: Path) -> Python:
    """Run Python in a copy of the checkout to which the diff of a section has been applied."""
    for name in ('kapitsa_ros', 'config'):
        shutil.copytree(ROOT / name, tmp_path / name)  # compiled kernels come along
    shutil.copy(ROOT / 'package.xml', tmp_path)
    (diff,) = DIFF.findall(SECTIONS[request.param])
    # A folder of temporary files may lie within some repository, whose root paths would be taken from.
    environment = {**os.environ, 'GIT_CEILING_DIRECTORIES': str(tmp_path.parent)}
    git = shutil.which('git')
    assert git is not None
    subprocess.run([git, 'apply', '-'], input=diff, text=True, check=True, cwd=tmp_path, env=environment)

    def run(*arguments: str) -> str:
        done = subprocess.run(
            [sys.executable, *arguments],
            cwd=tmp_path,
            env={**os.environ, 'PYTHONPATH': str(tmp_path)},
            stdout=subprocess.PIPE,
            check=True,
            text=True,
            timeout=300,
        )
        return done.stdout

    return run


@pytest.mark.parametrize('extended', ['A recorded sensor'], indirect=True)
def test_a_sensor_is_recorded_analysed_and_replayed(extended: Python, tmp_path: Path) -> None:
    (tmp_path / 'short.yaml').write_text('speeds: [2500 rpm]\nrelease: 0.1 rad\nswings: 1\nrepeats: 1\n', 'utf-8')
    arguments = ['-m', 'kapitsa_ros', 'experiment', '--protocol', 'short.yaml', '--bags', 'runs', '--json']
    (run,) = json.loads(extended(*arguments))['runs']
    speeds = json.loads(extended('-c', READ, run['bag']))
    assert speeds[-1] == pytest.approx(2500 * 2 * math.pi / 60, rel=0.005)
    assert speeds[-1] != speeds[-2]  # it has a stream of random numbers
    (replayed,) = json.loads(extended('-m', 'kapitsa_ros', 'replay', run['bag'], '--json'))['runs']
    assert replayed == run


@pytest.mark.parametrize('extended', ['A recorded sensor'], indirect=True)
def test_bags_that_are_older_than_the_sensor_are_read_and_replayed(extended: Python) -> None:
    shipped = str(ROOT / 'bags' / 'run_01_2240rpm')
    assert json.loads(extended('-c', READ, shipped)) == []
    (analysed,) = json.loads(extended('-m', 'kapitsa_ros', 'analyse', shipped, '--json'))['runs']
    (replayed,) = json.loads(extended('-m', 'kapitsa_ros', 'replay', shipped, '--json'))['runs']
    assert replayed == analysed


@pytest.mark.parametrize('extended', ['An estimator of the slow frequency'], indirect=True)
def test_an_estimator_finds_the_frequency_of_a_swing(extended: Python) -> None:
    found = extended(
        '-c',
        'import numpy as np\n'
        'from kapitsa_ros.analysis.slow_frequency import SwingRecord, turning_point_frequency\n'
        't = np.arange(10_000) * 1e-3\n'
        'angle = 0.1 * np.cos(8 * t) * (1 + 0.05 * np.cos(240 * t))\n'
        'print(turning_point_frequency(SwingRecord(angle=angle, period=1e-3, forcing=240.0)).value)\n',
    )
    assert float(found) == pytest.approx(8.0, rel=0.02)


@pytest.mark.parametrize('extended', ['A command'], indirect=True)
def test_a_command_is_found_by_its_name(extended: Python) -> None:
    period = json.loads(extended('-m', 'kapitsa_ros', 'period', '--speed', '2500', '--json'))['period_s']
    (speed,) = json.loads(extended('-m', 'kapitsa_ros', 'theory', '--speed', '2500', '--json'))['speeds']
    assert period == pytest.approx(60 / speed['slow_exact_rpm'])
