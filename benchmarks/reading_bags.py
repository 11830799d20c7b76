"""θ(t) from a bag, against a loop over the messages of a JointState bag of the same samples by rosbags' AnyReader."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from measure import Claim, cpu
from rosbags.highlevel import AnyReader

import kapitsa_ros as kr
from kapitsa_ros.laboratory.recomputed_run import RecomputedRun
from kapitsa_ros.network.registry import COMMAND, REPLAYED
from kapitsa_ros.network.step_clock import SECOND, StepClock
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.operator.command import Command
from kapitsa_ros.recording.export_files import export
from kapitsa_ros.recording.joint_samples import read_joint
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.recording.sealed_motion import read_motion
from kapitsa_ros.recording.writer import RunWriter

if TYPE_CHECKING:
    from kapitsa_ros.network.run import Run

SHIPPED = Path(__file__).resolve().parents[1] / 'bags' / 'run_01_2240rpm'


def loop(path: Path) -> np.ndarray:
    """Return stamps and positions, message by message."""
    rows = []
    with AnyReader([path]) as reader:
        for connection, _, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            rows.append((message.header.stamp.sec * 10**9 + message.header.stamp.nanosec, message.position[0]))
    return np.array(rows)


def steps_of(run: Run, seconds: float, sample_rate: float) -> list[tuple[int, dict[str, bytes]]]:
    """Return stamp and messages of every step of a run by its settings, and of its end, at another rate of samples."""
    settings = {**run.settings, 'jigsaw': {**run.settings['jigsaw'], 'sample_rate': sample_rate}}
    again = RecomputedRun(replace(run, settings=settings))
    clock, steps = StepClock(SECOND // 10), []
    for number in range(round(10 * seconds)):
        step_id = StepId(run.number, number)
        command = Command(run.speed_asked, 0.12 if number < 20 else None)
        messages = {topic.name: raw for topic, raw in again.step(step_id, command).items()}
        messages[COMMAND.name] = COMMAND.encode(clock.start_ns(step_id), step_id, command)
        steps.append((clock.start_ns(step_id), messages))
    end = StepId(run.number, len(steps), end=True)
    stamp = clock.start_ns(end)
    return [*steps, (stamp, {topic.name: topic.codec.encode_silence(stamp, end) for topic in REPLAYED[1:]})]


def record(writer: RunWriter, steps: list[tuple[int, dict[str, bytes]]]) -> None:
    """Write steps as the recorder does."""
    for stamp, messages in steps:
        writer.write_step(stamp, messages)


def main() -> None:
    """Measure and print."""
    with tempfile.TemporaryDirectory() as folder:
        ours, unpacked, joints = Path(folder) / 'run', Path(folder) / 'unpacked', Path(folder) / 'joints'
        shipped = RunBag(SHIPPED)
        steps = steps_of(shipped.run, 60.0, 2000.0)
        writers = (RunWriter(Path(folder) / f'run_{number}', 'mcap', shipped.settings_texts, 5) for number in range(99))
        for path, compression in ((ours, 'zstd'), (unpacked, 'none')):
            writer = RunWriter(path, 'mcap', shipped.settings_texts, 5, compression=compression)
            record(writer, steps)
            writer.close(complete=True)
        export(RunBag(ours), 'joint-states', joints)
        rows = loop(joints)
        motion, as_it_is, joint = read_motion(ours), read_motion(unpacked), read_joint(joints, 'pendulum')
        bag_s, unpacked_s, joint_s, loop_s = cpu(
            lambda: read_motion(ours),
            lambda: read_motion(unpacked),
            lambda: read_joint(joints, 'pendulum'),
            lambda: loop(joints),
        )
        peer = 'AnyReader, a loop over JointState'
        for work, target, cost, angle in (
            ('θ(t) of 60 s at 2 kHz from a bag (zstd), its digest checked', '>= 100', bag_s, motion.angle),
            ('the same, recorded with compression none', '>= 300', unpacked_s, as_it_is.angle),
            ('the same from JointState of others (zstd)', '>= 50', joint_s, joint.position),
        ):
            error = float(np.abs(angle - rows[:, 1]).max())
            Claim(
                work=work, peer=peer, target=target, ours_s=cost, peer_s=loop_s, ours_error=error, peer_error=0.0
            ).show()
        for rate in (1000.0, 2000.0):
            steps = steps_of(shipped.run, 60.0, rate)
            (write_s,) = cpu(lambda steps=steps: record(next(writers), steps))
            Claim(
                work=f'recording a step at {rate / 1000:g} kHz, digest included', peer='the target of 0.25 ms',
                target='>= 1', ours_s=write_s / len(steps), peer_s=0.25e-3, ours_error=None, peer_error=None,
            ).show()  # fmt: skip
        (verify_s,) = cpu(lambda: kr.verify(SHIPPED.parent))
        Claim(
            work='verify of the three shipped runs', peer='the target of 3 s', target='>= 1', ours_s=verify_s,
            peer_s=3.0, ours_error=None, peer_error=None,
        ).show()  # fmt: skip


if __name__ == '__main__':
    main()
