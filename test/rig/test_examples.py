"""The examples work as they stand: scripts of their own beside a rig, and a user's own test."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from kapitsa_ros.network.registry import ROLE_NAMES
from kapitsa_ros.rig import Rig
from kapitsa_ros.rig.environment import node_environment

EXAMPLES = Path(__file__).parents[2] / 'examples'
pytestmark = pytest.mark.xdist_group('harness')


def test_bisection_finds_the_critical_speed(tmp_path: Path) -> None:
    with Rig(nodes=[role for role in ROLE_NAMES if role != 'operator'], bags=tmp_path) as rig:
        done = subprocess.run(
            [sys.executable, EXAMPLES / 'bisection.py'], env=node_environment(rig.domain),
            capture_output=True, text=True, timeout=120, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        rig.wait_for('analyser/result', lambda result: 'experiment' in result)
    assert float(done.stdout) == pytest.approx(1354.8036, abs=1.0)
    assert len(list(tmp_path.iterdir())) == 11  # 1000 RPM halved eleven times are less than a half


def test_the_readme_shows_the_users_own_test() -> None:
    readme = (EXAMPLES.parent / 'README.md').read_text(encoding='utf-8')
    assert f'```python\n{(EXAMPLES / "test_tachometer.py").read_text(encoding="utf-8")}```' in readme


def test_a_users_own_test_passes() -> None:
    command = [sys.executable, '-m', 'pytest', '-p', 'kapitsa_ros.rig.pytest_plugin', '-p', 'no:cacheprovider']
    done = subprocess.run(
        [*command, '--import-mode=prepend', EXAMPLES / 'test_tachometer.py'],
        env=os.environ | {'PYTEST_ADDOPTS': ''},  # colcon's options are of this suite
        capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    assert '1 passed' in done.stdout
