"""An installed prefix is one that `ros2 run` understands: index marker, share, executables with their mode."""

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable
from importlib.metadata import distribution
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from ament_index_python.packages import get_package_prefix, get_packages_with_prefixes

import kapitsa_ros
from kapitsa_ros.rig.environment import loopback

EXECUTABLES = {
    'jigsaw', 'pendulum', 'strobe', 'stopwatch', 'operator', 'analyser', 'recorder', 'player', 'composed',
    'foxglove_server',
}  # fmt: skip
CHECKOUT = Path(__file__).parents[1]

pytestmark = pytest.mark.xdist_group('install')  # it is installed once, for all


@pytest.fixture(scope='module')
def prefix(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Install the package as `pip install .` does, into a prefix of its own; dependencies are here already."""
    prefix = tmp_path_factory.mktemp('prefix')
    source = tmp_path_factory.mktemp('source') / 'kapitsa_ros'
    shutil.copytree(
        CHECKOUT, source, symlinks=True, ignore=shutil.ignore_patterns('.*', '__pycache__', 'runs', 'build')
    )
    options = ['--quiet', '--no-deps', '--no-build-isolation', '--disable-pip-version-check', '--ignore-installed']
    subprocess.run([sys.executable, '-m', 'pip', 'install', *options, '--prefix', prefix, source], check=True)
    return prefix


@pytest.fixture
def index(prefix: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Let the ament index look there."""
    monkeypatch.setenv('AMENT_PREFIX_PATH', str(prefix))
    return prefix


RESOLVED = {
    'ament_index_python', 'builtin_interfaces', 'diagnostic_msgs', 'domain_coordinator', 'launch', 'launch_ros',
    'mcap-ros2-support', 'python3-click', 'python3-hypothesis', 'python3-numba', 'python3-numpy', 'python3-pytest',
    'python3-pytest-xdist', 'python3-rich', 'python3-rosbags-pip', 'python3-scipy', 'python3-setproctitle',
    'python3-yaml', 'rcl_interfaces', 'rclpy', 'ros2launch', 'rosgraph_msgs', 'sensor_msgs', 'std_msgs', 'std_srvs',
    'trajectory_msgs',
}  # fmt: skip
"""Packages of Jazzy, and keys of rosdep's public list that lead to something on Ubuntu (August 2026)."""


def test_rosdep_knows_every_key() -> None:
    """There is no python3-lz4, and no python3-zstandard, however likely they look."""
    named = {each.text for each in ET.parse(CHECKOUT / 'package.xml').getroot() if each.tag.endswith('depend')}
    assert named <= RESOLVED
    imported = {
        name
        for path in [*CHECKOUT.glob('kapitsa_ros/**/*.py'), *CHECKOUT.glob('launch/*.py')]
        for name in re.findall(r'^ *(?:from|import) (\w+)', path.read_text(encoding='utf-8'), re.MULTILINE)
    }
    assert {name for name in imported if name.endswith(('_msgs', '_interfaces', '_srvs')) or 'rcl' in name} <= named


def test_the_index_knows_the_package(index: Path) -> None:
    assert get_packages_with_prefixes()['kapitsa_ros'] == str(index)


def test_executables_are_where_ros2_run_looks(index: Path) -> None:
    folder = Path(get_package_prefix('kapitsa_ros')) / 'lib' / 'kapitsa_ros'
    files = [path for path in folder.iterdir() if os.access(path, os.X_OK)]
    assert {path.name for path in files} == EXECUTABLES
    assert (index / 'bin' / 'kapitsa').is_file()


def test_share_holds_what_launch_and_params_need(index: Path) -> None:
    share = index / 'share' / 'kapitsa_ros'
    for name in ('package.xml', 'config/presets/ideal.yaml', 'config/loopback.xml', 'config/viewers/kapitsa.rviz'):
        assert (share / name).is_file()
    launch = {path.name for path in (CHECKOUT / 'launch').glob('*.launch.py')}
    assert {path.name for path in (share / 'launch').glob('*.launch.py')} == launch >= {'rig.launch.py'}
    for path in (share / 'launch').glob('*.launch.py'):
        compile(path.read_text(encoding='utf-8'), path.name, 'exec')


def test_the_page_of_the_bench_is_installed(prefix: Path) -> None:
    for folder in ('static', 'words'):
        [there] = prefix.glob(f'lib/python*/site-packages/kapitsa_ros/web/{folder}')
        names = {path.name for path in (CHECKOUT / 'kapitsa_ros' / 'web' / folder).iterdir()}
        assert {path.name for path in there.iterdir()} == names


@pytest.fixture
def installed(index: Path, domain: int) -> Callable[..., subprocess.Popen[str]]:
    """Start an executable as `ros2 run` does: found in the index, from the installed files."""

    def start(role: str, *arguments: str) -> subprocess.Popen[str]:
        environment = {
            'PYTHONPATH': str(next(index.glob('lib/python*/site-packages'))),
            'PATH': f'{Path(sys.executable).parent}:{os.environ["PATH"]}',
            'ROS_DOMAIN_ID': str(domain),
            'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
        }
        return subprocess.Popen(
            [Path(get_package_prefix('kapitsa_ros')) / 'lib' / 'kapitsa_ros' / role, '--ros-args', *arguments],
            env=os.environ | loopback() | environment,  # other transports leave their ports in /dev/shm
            cwd=index,
            stderr=subprocess.PIPE,
            text=True,
        )

    return start


@pytest.mark.parametrize('role', ['jigsaw', 'analyser'])
def test_an_installed_executable_runs_the_node(installed: Callable[..., subprocess.Popen[str]], role: str) -> None:
    """It waits for its peers, and leaves on Ctrl-C."""
    process = installed(role, '-p', 'expect:=[jigsaw, operator, strobe, analyser]')
    try:
        assert process.stderr is not None
        assert next(line for line in process.stderr if 'waiting for' in line)
    finally:
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=20)
    assert process.returncode == 0
    assert 'Traceback' not in err


@pytest.mark.parametrize(
    ('role', 'wrong', 'said'),
    [
        ('jigsaw', 'rate:=1', 'parameter rate must be a double: write 1.0 for 1'),
        ('jigsaw', 'amplitude:=-0.1', 'parameter amplitude is -0.1: it must be a finite value in [1e-06, 100.0]'),
        ('operator', 'protocol:=/no/such', "parameter protocol: no protocol '/no/such'"),
        ('player', "bags:=['/no/such']", 'parameter bags: /no/such'),
    ],
)
def test_an_installed_executable_refuses_a_wrong_parameter_in_one_line(
    installed: Callable[..., subprocess.Popen[str]], role: str, wrong: str, said: str
) -> None:
    process = installed(role, '-p', wrong)
    _, err = process.communicate(timeout=180)
    assert process.returncode == 2
    assert err.startswith(f'{role}: error: {said}')
    assert err.count('\n') == 1


def test_links_to_what_is_installed_are_enough_to_build(tmp_path: Path) -> None:
    """`colcon build --symlink-install` runs a link to setup.py; README.md is not beside it."""
    for name in ('setup.py', 'setup.cfg', 'package.xml', 'kapitsa_ros', 'config', 'launch'):
        (tmp_path / name).symlink_to(CHECKOUT / name)
    done = subprocess.run(
        [sys.executable, 'setup.py', '--name'], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.stdout.splitlines()[-1:] == ['kapitsa_ros'], done.stderr
    assert {path.name for path in (tmp_path / 'build' / 'node_scripts').iterdir()} == EXECUTABLES


def test_what_is_pinned_is_pinned_by_its_hash():
    pinned = re.findall(r'^([\w.-]+==\S+)$', (CHECKOUT / 'constraints.txt').read_text('utf-8'), re.MULTILINE)
    locked = ''.join((CHECKOUT / f'requirements{name}.txt').read_text('utf-8') for name in ('', '-build'))
    by_hash = re.findall(r'^([\w.-]+==\S+) \\\n    --hash=sha256:[0-9a-f]{64}', locked, re.MULTILINE)
    assert len(pinned) > 100
    assert sorted(by_hash) == sorted(pinned)


def test_versions_are_told_where_the_package_is_on_the_path_alone(tmp_path: Path) -> None:
    """As under `colcon test`, or after a clone: nodes died of metadata that were not there."""
    for name in ('numpy', 'scipy', 'numba'):
        [metadata] = Path(str(distribution(name).locate_file(''))).glob(f'{name}-*.dist-info')
        (tmp_path / metadata.name).symlink_to(metadata)
    program = 'from kapitsa_ros.versions import versions; print(versions()["kapitsa_ros"])'
    environment = os.environ | {'PYTHONPATH': f'{tmp_path}:{CHECKOUT}'}
    command = [sys.executable, '-S', '-c', program]  # without what is installed
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == kapitsa_ros.__version__
