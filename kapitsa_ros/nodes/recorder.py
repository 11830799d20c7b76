"""The recorder: one bag a run, the messages of each step in a fixed order, acknowledged when they are written."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from rclpy.logging import get_logger

from kapitsa_ros.network.registry import COMMAND, RECORDER, WRITTEN
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.naming import run_name
from kapitsa_ros.recording.writer import COMPRESSIONS, STORAGES, RunWriter
from kapitsa_ros.ros.dataflow_node import LOOK_PERIOD
from kapitsa_ros.ros.errors import NodeError, SettingError
from kapitsa_ros.ros.parameters import declare
from kapitsa_ros.ros.settings_subscriber import SettingsSubscriber
from kapitsa_ros.ros.step_node import StepNode

if TYPE_CHECKING:
    from kapitsa_ros.network.step import Step


class RecorderNode(StepNode):
    """Executable `recorder`."""

    def __init__(self) -> None:
        super().__init__(RECORDER)
        self._bags = Path(declare(self, 'bags', 'runs', 'folder in which each run gets a bag of its own'))
        self._storage = declare(self, 'storage', 'mcap', f'of the bags: {" or ".join(STORAGES)}')
        self._compression = declare(self, 'compression', 'zstd', f'of the chunks in MCAP: {" or ".join(COMPRESSIONS)}')
        self._steps_a_chunk = declare(
            self, 'steps_a_chunk', 5, 'steps that a crash may cost, half a second at most', 1, 1000
        )
        for name, value, choices in (
            ('storage', self._storage, STORAGES),
            ('compression', self._compression, COMPRESSIONS),
        ):
            if value not in choices:
                raise SettingError(f'parameter {name} is {value!r}: choose {" or ".join(choices)}')
        if not _can_be_filled(self._bags):
            raise SettingError(f'parameter bags: {self._bags} cannot be written; give a folder you can write to')
        self._settings = SettingsSubscriber(self)
        self._writer: RunWriter | None = None

    def advance(self) -> float:
        """Wait for the settings, which open a bag; see to it that what was written is on disk."""
        if not self._settings.complete:
            return LOOK_PERIOD
        wait = super().advance()
        return wait if self._writer is None else min(wait, self._on_disk(self._writer))

    def _on_disk(self, writer: RunWriter) -> float:
        try:
            return writer.sync()
        except BagError as error:
            self._give_up()
            raise NodeError(str(error)) from error

    def work(self, step: Step) -> None:
        """Write one step."""
        try:
            if self._writer is None:
                path = self._bags / run_name(step.id.run, step[COMMAND].speed)
                self._writer = RunWriter(
                    path,
                    self._storage,
                    self._settings.texts,
                    self._steps_a_chunk,
                    compression=self._compression,
                )
                self._settings.begin_run()
            self._writer.write_step(step.stamp_ns, step.raw)
        except BagError as error:
            self._give_up()
            raise NodeError(str(error)) from error
        self.emit_silence(WRITTEN, step.id, step.stamp_ns)

    def end_run(self, step: Step) -> None:
        """Write the end of the run and finish its bag."""
        if self._writer is not None:
            try:
                self._writer.write_step(step.stamp_ns, step.raw)
                self._writer.close(complete=True)
            except BagError as error:
                self._give_up()
                raise NodeError(str(error)) from error
            self.get_logger().info(f'{self._writer.path} is written')
            self._writer = None
        super().end_run(step)

    def close(self) -> None:
        """Finish a bag whose run did not come to its end: it can be read, and says so."""
        if self._writer is not None:
            self._writer.close(complete=False)
            # The node's own logger would complain that it cannot publish the line after a signal.
            logger = self.get_logger() if self.context.ok() else get_logger(f'{self.get_logger().name}.bag')
            text = f'{self._writer.path} holds a run that was interrupted: it can be read, and says that it has no end'
            logger.warning(text)

    def _give_up(self) -> None:
        """Leave a bag that the disk does not take as it is: without an index nobody takes it for whole."""
        if self._writer is not None:
            self._writer.abort()
            self._writer = None


def _can_be_filled(folder: Path) -> bool:
    """Whether it can be written, or be made: a run of others would end with its first step if not."""
    try:
        there = next(path for path in (folder.absolute(), *folder.absolute().parents) if path.exists())
    except OSError:  # as of a name that is too long
        return False
    return there.is_dir() and os.access(there, os.W_OK | os.X_OK)


create = RecorderNode
