"""A script of ten lines a call, run as a user runs it."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip('pandas')
pytest.importorskip('matplotlib')

import kapitsa_ros as kr

CHECKOUT = Path(__file__).parents[2]
SCRIPTS = CHECKOUT / 'examples' / 'front_door'
BAGS = sorted((CHECKOUT / 'bags').glob('run_*'))
ARGUMENTS = {'read_bag': BAGS[:1], 'read_motion': BAGS[:1], 'report': BAGS, 'verify': BAGS}
SAID = {
    'theory': 'critical speed  141.875 rad/s (1354.8 RPM)',
    'simulate': 'speed     261.799 rad/s (2500 RPM)',
    'stability_map': 'speeds      700 of 52.3599 rad/s (500 RPM)',
    'read_bag': 'angle_rad',
    'read_motion': ' samples, 0 gaps\n',
    'reduce': 'inverse ols          171.74 rad/s (1639.99 RPM)',
    'explain': 'inertia_factor',
    'figures': 'figures/figure_2.svg',
    'plan': 'PlannedProtocol',
    'campaign': 'CampaignResult: 16 experiments, 0 without',
    'experiment': 'ExperimentResult: 3 runs',
    'report': 'Report on 3 runs: report.html',
    'rig': 'StopwatchReading',
    'verify': 'run_01_2240rpm: identical\n',
}
GRAPHS = ('experiment', 'rig')


def test_every_call_has_its_script_of_ten_lines() -> None:
    short = {'Plant', 'preset', 'rpm', 'KapitsaError'}
    assert (
        {name.lower() for name in set(kr.__all__) - short}
        == {path.stem for path in SCRIPTS.glob('*.py')}
        == SAID.keys()
    )
    for path in SCRIPTS.glob('*.py'):
        lines = [line for line in path.read_text(encoding='utf-8').splitlines() if line]
        assert len(lines) <= 10


@pytest.mark.parametrize(
    'name',
    [pytest.param(name, marks=[pytest.mark.xdist_group('graphs')] if name in GRAPHS else []) for name in SAID],
)
def test_the_script_says_what_it_should(name: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [sys.executable, SCRIPTS / f'{name}.py', *ARGUMENTS.get(name, ())],
        cwd=tmp_path, env=os.environ | {'PYTHONPATH': str(CHECKOUT)}, capture_output=True, text=True, timeout=300,
        check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert SAID[name] in done.stdout
