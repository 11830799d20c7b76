"""What README has shown to users stays valid; where something better has taken its place, the old name warns."""

import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path

import pytest

SHIPPED = Path(__file__).parents[1] / 'bags' / 'run_01_2240rpm'


def test_a_run_is_read_as_the_readme_of_the_first_release_showed() -> None:
    from kapitsa_ros.recording.reader import RunBag

    bag = RunBag(SHIPPED)
    assert bag.run.speed_reading == pytest.approx(234.57, abs=0.01)
    assert bag.run.period == pytest.approx(0.93, abs=0.2)
    assert bag.run.plant.inertia_factor == 0.7069
    assert bag.motion.angle.max() > 0.1
    assert bag.motion.gaps == 0
    assert bag.complete


def test_the_rig_is_found_where_it_always_was() -> None:
    from kapitsa_ros import rig
    from kapitsa_ros.rig import Rig, RigError
    from kapitsa_ros.rig.harness import Rig as Harness

    assert Rig is Harness is rig.Rig
    assert issubclass(RigError, Exception)


def test_the_plugin_has_its_name_and_its_fixture(pytestconfig: pytest.Config) -> None:
    (plugin,) = (point for point in entry_points(group='pytest11') if point.name.startswith('kapitsa_ros'))
    assert plugin.name == plugin.value == 'kapitsa_ros.rig.pytest_plugin'
    assert any(line.startswith('rig(') for line in pytestconfig.getini('markers'))


def test_the_kernels_are_compiled_under_the_old_name_too_which_warns() -> None:
    command = [sys.executable, '-W', 'always', '-m', 'kapitsa_ros.physics.warm']
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert 'DeprecationWarning: kapitsa_ros.physics.warm is now kapitsa_ros.physics.compile_kernels' in done.stderr


@pytest.mark.parametrize('module', ['kapitsa_ros', 'kapitsa_ros.rig'])
def test_the_command_line_is_a_module(module: str) -> None:
    done = subprocess.run([sys.executable, '-m', module, '--version'], capture_output=True, text=True, check=True)
    assert done.stdout.startswith('kapitsa, version ')
