"""The graph at rate 1, with a viewer: cores used, deadlines missed, frames shown; as processes and composed.

The seconds are the first argument (default 60); CPU time is of the nodes, from their first step on.
"""

from __future__ import annotations

import json
import sys
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

import rclpy
from measure import cpu_of
from rclpy.context import Context
from rclpy.experimental import EventsExecutor
from rclpy.node import Node
from sensor_msgs.msg import JointState

from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.rig import Rig
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.ros.arguments import NO_LOG_FILES
from kapitsa_ros.ros.qos import VIEW
from kapitsa_ros.ros.session_monitor import SessionMonitor


def main() -> None:
    """Print the claims as JSON."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0
    for composed, how in ((False, 'as processes'), (True, 'composed')):
        cores, misses, frames, gaps = watched(seconds, composed=composed)
        seen = f'{misses} deadlines missed, {gaps} gaps, {frames:.0f} frames/s'
        work = f'{seconds:g} s at rate 1, {how}: cores used ({seen})'
        print(json.dumps({'work': work, 'target': '<= 0.2', 'ratio': cores}), flush=True)


def watched(seconds: float, *, composed: bool) -> tuple[float, int, float, int]:
    """Run a rig in real time with a viewer; return cores used, deadlines missed, frames a second and recorded gaps."""
    frames = 0

    def count(_: JointState) -> None:
        nonlocal frames
        frames += 1

    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        bags = Path(folder, 'bags')
        rig = stack.enter_context(Rig(rate=1.0, bags=bags, composed=composed))
        with on_loopback():
            monitor = stack.enter_context(SessionMonitor(rig.domain))
            context = Context()
            rclpy.init(args=NO_LOG_FILES, context=context, domain_id=rig.domain)
            viewer = Node('viewer', context=context)
        viewer.create_subscription(JointState, 'joint_states', count, VIEW)
        executor = EventsExecutor(context=context)
        executor.add_node(viewer)
        rig.request_speed(2500)
        rig.wait_for('pendulum/motion')
        pids = {process.pid for process in rig.processes.values()}
        before = sum(map(cpu_of, pids))
        frames, end = 0, time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            executor.spin_once(timeout_sec=left)
            rig.news(0.0)
        cores = (sum(map(cpu_of, pids)) - before) / seconds
        misses = int(monitor.progress['deadline_misses'])
        rig.reset()
        executor.shutdown()
        del executor
        viewer.destroy_node()
        context.try_shutdown()
        [bag] = bags.glob('run_01_*')
        gaps = RunBag(bag).motion.gaps
    return cores, misses, frames / seconds, gaps


if __name__ == '__main__':
    main()
