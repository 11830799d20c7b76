"""A recorder that knows nothing of this package keeps a session of a running rig, as `ros2 bag record -a` does."""

import signal
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path

import pytest
from mutations import meaning

import kapitsa_ros as kr
from kapitsa_ros.network.registry import RECORDED
from kapitsa_ros.recording.reader import RunBag, open_runs
from kapitsa_ros.rig.environment import node_environment

PATIENCE = 180.0
FORMS = ['mcap-none', 'mcap-message', 'mcap-file', 'sqlite3-none', 'sqlite3-message']
SCRIPT = """
import importlib, signal, sys, threading, time
import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.signals import SignalHandlerOptions
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

folder, topics, *forms = sys.argv[1:]
expected, store, writers = set(topics.split()), get_typestore(Stores.ROS2_JAZZY), []
for form in forms:
    storage, mode = form.split('-')
    writer = Writer(f'{folder}/{form}', version=9, storage_plugin=StoragePlugin[storage.upper()])
    if mode != 'none':
        writer.set_compression(CompressionMode[mode.upper()], CompressionFormat.ZSTD)
    writer.open()
    writers.append(writer)
rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
stopping = threading.Event()
signal.signal(signal.SIGINT, lambda *_: stopping.set())  # an exception would take a message with it
node = rclpy.create_node('rosbag2_recorder')
heard, written = set(), 0

def subscribe(topic, kind):
    offered = [end.qos_profile for end in node.get_publishers_info_by_topic(topic)]
    reliable = all(qos.reliability == ReliabilityPolicy.RELIABLE for qos in offered)
    latched = all(qos.durability == DurabilityPolicy.TRANSIENT_LOCAL for qos in offered)
    qos = QoSProfile(
        depth=1000,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )
    links = [(writer, writer.add_connection(topic, kind, typestore=store)) for writer in writers]

    def write(raw):
        global written
        written += 1
        heard.add(topic)
        for writer, link in links:
            writer.write(link, time.time_ns(), raw)
        if expected and heard >= expected:
            expected.clear()
            print(end='.', flush=True)

    package, _, name = kind.split('/')
    node.create_subscription(getattr(importlib.import_module(f'{package}.msg'), name), topic, write, qos, raw=True)

known = set()
while not stopping.is_set():
    for topic, [kind] in node.get_topic_names_and_types():
        if topic not in known and node.get_publishers_info_by_topic(topic):
            known.add(topic)
            subscribe(topic, kind)
    for _ in range(100):
        rclpy.spin_once(node, timeout_sec=0.01)
before = -1
while written > before:  # what has come and was not yet taken
    before = written
    rclpy.spin_once(node, timeout_sec=0.5)
for writer in writers:
    writer.close()
"""


@pytest.mark.xdist_group('processes')
def test_a_session_recorded_by_others_is_what_the_rig_itself_recorded(tmp_path: Path) -> None:
    topics = ' '.join(f'/{topic.name}' for topic in RECORDED)
    with ExitStack() as stack:
        with kr.Rig(rate=8.0, bags=tmp_path / 'own') as rig:
            recorder = stack.enter_context(
                subprocess.Popen(
                    [sys.executable, '-c', SCRIPT, str(tmp_path), topics, *FORMS],
                    env=node_environment(rig.domain),
                    stdout=subprocess.PIPE,
                )
            )
            stack.callback(recorder.kill)
            assert recorder.stdout is not None
            assert recorder.stdout.read(1) == b'.', 'it has heard of the topics, somewhere in the first run'
            rig.reset()
            rig.request_speed(2500)
            rig.wait_for('strobe/reading', lambda reading: reading.speed > 0, timeout=PATIENCE)
            rig.release(0.12)
            rig.wait_for('stopwatch/reading', timeout=PATIENCE)
            rig.reset()
            rig.wait_for('analyser/result', timeout=PATIENCE)
        recorder.send_signal(signal.SIGINT)
        assert recorder.wait(timeout=180) == 0
    own = {run.number: run for run in map(RunBag, sorted((tmp_path / 'own').iterdir()))}
    for form in FORMS:
        runs = {run.number: run for run in open_runs(tmp_path / form)}
        assert runs.keys() == {1, 2, 3}
        assert meaning(runs[2]) == meaning(own[2])
        assert runs[2].defects == ()
        assert runs[2].run.timings
        assert any('steps 0 to' in defect and 'of run 1: missing' in defect for defect in runs[1].defects)
