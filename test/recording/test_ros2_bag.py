"""`ros2 bag` shows, plays, converts and reindexes bags of this package, where it is installed."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest
import yaml
from bag_of_a_made_up_run import write
from mutations import meaning
from rosbags.rosbag2 import Reader

from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.rig.domain import reserved_domain
from kapitsa_ros.rig.environment import loopback

PACKAGES = 'ros-jazzy-ros2bag, ros-jazzy-rosbag2-storage-mcap and ros-jazzy-rosbag2-storage-sqlite3'
ROS2 = shutil.which('ros2')
HAS_BAG = ROS2 and not subprocess.run([ROS2, 'bag', '--help'], capture_output=True, timeout=180, check=False).returncode
pytestmark = pytest.mark.skipif(not HAS_BAG, reason=f'needs ros2 with its command bag on the PATH: {PACKAGES}')
STORAGES = pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])


def ros2_bag(*arguments: str | Path, domain: int | None = None) -> str:
    environment = os.environ | loopback() | {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST'}
    if domain is not None:
        environment['ROS_DOMAIN_ID'] = str(domain)
    command = ['ros2', 'bag', *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, env=environment, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def counts(bag: Path) -> dict[str, int]:
    with Reader(bag) as reader:
        return {topic: info.msgcount for topic, info in reader.topics.items()}


@STORAGES
def test_it_shows_a_bag(tmp_path: Path, storage: str) -> None:
    bag = write(tmp_path / 'run', storage=storage)
    shown = ros2_bag('info', bag)
    assert f'run_0.{"mcap" if storage == "mcap" else "db3"}' in shown
    for topic, count in counts(bag).items():
        assert any(topic in line and f'Count: {count} ' in line for line in shown.splitlines()), topic


@STORAGES
def test_it_plays_a_bag_to_its_end(tmp_path: Path, storage: str) -> None:
    with reserved_domain() as domain:
        ros2_bag('play', write(tmp_path / 'run', storage=storage), '--disable-keyboard-controls', domain=domain)


@STORAGES
def test_it_rebuilds_the_metadata(tmp_path: Path, storage: str) -> None:
    bag = write(tmp_path / 'run', storage=storage)
    right, before = meaning(RunBag(bag)), counts(bag)
    (bag / 'metadata.yaml').unlink()
    ros2_bag('reindex', bag, '-s', storage)
    assert meaning(RunBag(bag)) == right
    assert counts(bag) == before, 'a depth that other readers drop topics for'


@STORAGES
def test_it_converts_a_bag(tmp_path: Path, storage: str) -> None:
    bag = write(tmp_path / 'run', storage=storage)
    right, other = meaning(RunBag(bag)), 'sqlite3' if storage == 'mcap' else 'mcap'
    options = {'output_bags': [{'uri': str(tmp_path / 'converted'), 'storage_id': other, 'all_topics': True}]}
    (tmp_path / 'options.yaml').write_text(yaml.safe_dump(options))
    ros2_bag('convert', '-i', bag, '-o', tmp_path / 'options.yaml')
    assert meaning(RunBag(tmp_path / 'converted')) == right
