"""A run of twelve steps that nobody simulated, and its bag."""

from pathlib import Path

import numpy as np

from kapitsa_ros.instruments.stopwatch import StopwatchReading
from kapitsa_ros.instruments.strobe import StrobeReading
from kapitsa_ros.network import registry
from kapitsa_ros.network.step_clock import SECOND, StepClock
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.operator.command import Command
from kapitsa_ros.physics.sampled_motion import SampledMotion
from kapitsa_ros.recording.writer import RunWriter
from kapitsa_ros.units import RPM

CLOCK = StepClock(SECOND // 10)
SETTINGS = {
    'jigsaw': '{"amplitude": 0.0127}',
    'pendulum': '{"plant": {"length": 0.24765}}',
    'strobe': '{"seed": 1}',
    'stopwatch': '{"swings": 3}',
}


def step_messages(step_id: StepId, samples: int = 100) -> dict[str, bytes]:
    """Return the messages of a step of a made-up run: let go at step 4, both readings at step 8."""
    stamp = CLOCK.start_ns(step_id)
    if step_id.end:
        return {topic.name: topic.codec.encode_silence(stamp, step_id) for topic in registry.RECORDED[1:]}
    time = CLOCK.start(step_id) + np.linspace(0.0, 0.1, samples + 1)
    motion = SampledMotion(0.1 / samples, np.sin(time), np.cos(time), -np.sin(time))
    read = step_id.step == 8
    strobe = StrobeReading(time=CLOCK.start(step_id), speed=234.0) if read else None
    timed = StopwatchReading(pressed_at=CLOCK.start(step_id), displayed=1.5, swings=3, kind='timed') if read else None
    return {
        registry.COMMAND.name: registry.COMMAND.encode(
            stamp, step_id, Command(2240 * RPM, 0.12 if step_id.step < 4 else None)
        ),
        registry.PIVOT.name: registry.PIVOT.encode(stamp, step_id, motion),
        registry.MOTION.name: registry.MOTION.encode(stamp, step_id, motion),
        registry.STROBE_READING.name: registry.STROBE_READING.encode(stamp, step_id, strobe),
        registry.STOPWATCH_READING.name: registry.STOPWATCH_READING.encode(stamp, step_id, timed),
        registry.RESULT.name: registry.RESULT.codec.encode_silence(stamp, step_id),
    }


def write(
    path: Path,
    *,
    storage: str = 'mcap',
    compression: str = 'zstd',
    leave_out: int | None = None,
    end: bool = True,
    samples: int = 100,
    settings: dict[str, str] = SETTINGS,
) -> Path:
    writer = RunWriter(path, storage, settings, steps_a_chunk=5, compression=compression)
    for step in range(12):
        if step != leave_out:
            writer.write_step(CLOCK.start_ns(StepId(1, step)), step_messages(StepId(1, step), samples))
    if end:
        writer.write_step(CLOCK.start_ns(StepId(1, 12)), step_messages(StepId(1, 12, end=True), samples))
    writer.close(complete=end)
    return path
