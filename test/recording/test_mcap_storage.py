"""MCAP files are those of rosbags, byte for byte."""

from pathlib import Path

import pytest
from bag_of_a_made_up_run import CLOCK, step_messages
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from kapitsa_ros.network import registry
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.recording.bag_writer import BagWriter


def written(kind: type[Writer], bag: Path, samples: int) -> dict[str, bytes]:
    store = get_typestore(Stores.ROS2_JAZZY)
    with kind(bag, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        links = {
            topic.name: writer.add_connection(topic.name, topic.type, typestore=store) for topic in registry.RECORDED
        }
        for step in (*range(12), 3):  # the last one comes late
            number = StepId(1, step)
            for topic, raw in step_messages(number, samples).items():
                writer.write(links[topic], CLOCK.start_ns(number), raw)
    return {path.name: path.read_bytes() for path in bag.iterdir()}


@pytest.mark.parametrize('samples', [10, 2000])
def test_they_have_the_same_bytes(tmp_path: Path, samples: int) -> None:
    """With all in one chunk, and with several that fill up."""
    ours, theirs = (written(kind, tmp_path / kind.__name__ / 'run', samples) for kind in (BagWriter, Writer))
    assert set(ours) == {'metadata.yaml', 'run.mcap'}
    assert ours == theirs


def test_they_have_them_without_a_message(tmp_path: Path) -> None:
    for kind in (BagWriter, Writer):
        with kind(tmp_path / kind.__name__ / 'run', version=9, storage_plugin=StoragePlugin.MCAP) as writer:
            writer.add_connection('/a', 'std_msgs/msg/Header', typestore=get_typestore(Stores.ROS2_JAZZY))
    ours, theirs = ((tmp_path / name / 'run' / 'run.mcap').read_bytes() for name in ('BagWriter', 'Writer'))
    assert ours == theirs
