"""The analyser: builds each run from commands and readings, never from the motion, and reduces what there is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kapitsa_ros.analysis.results import experiment_values, run_values
from kapitsa_ros.network.registry import ANALYSER, COMMAND, READINGS, RESULT
from kapitsa_ros.network.run_builder import RunBuilder
from kapitsa_ros.network.step_id import ends_session
from kapitsa_ros.ros.dataflow_node import LOOK_PERIOD
from kapitsa_ros.ros.settings_subscriber import SettingsSubscriber
from kapitsa_ros.ros.step_node import StepNode

if TYPE_CHECKING:
    from kapitsa_ros.network.run import Run
    from kapitsa_ros.network.step import Step


class AnalyserNode(StepNode):
    """Executable `analyser`. Its result for a step acknowledges that step."""

    def __init__(self) -> None:
        super().__init__(ANALYSER)
        self._settings = SettingsSubscriber(self)
        self._runs: list[Run] = []
        self._builder: RunBuilder

    def advance(self) -> float:
        """Wait for the settings, without which a run has no meaning."""
        return super().advance() if self._settings.complete else LOOK_PERIOD

    def work(self, step: Step) -> None:
        """Take in one step."""
        if step.id.step == 0:
            self._builder = RunBuilder(step.id.run, self._settings.parsed())
            self._settings.begin_run()
        self._builder.add(step[COMMAND], {topic: step[topic] for topic in READINGS if topic in step})
        self.emit_silence(RESULT, step.id, step.stamp_ns)

    def end_run(self, step: Step) -> None:
        """Say what the run came to; at the end of the session, what all runs came to together."""
        if ends_session(step.id):
            # Not above: this loads SciPy, for which no run should have to wait.
            from kapitsa_ros.analysis.experiment import reduce_runs  # noqa: PLC0415

            results = {'experiment': experiment_values(reduce_runs(self._runs))} if self._runs else {}
        else:
            run = self._builder.build(complete=True)
            self._runs.append(run)
            results = {f'run {run.number}': run_values(run)}
        for name, values in results.items():
            told = ', '.join(f'{key} {_short(value)}' for key, value in values.items() if _is_short(value))
            self.get_logger().info(f'{name}: {told}')
        self.emit(RESULT, step.id, step.stamp_ns, results)


def _is_short(value: Any) -> bool:
    """Whether it is a number, a word or an interval; the rest is in the result."""
    if isinstance(value, list):
        return 1 <= len(value) <= 2 and all(map(_is_short, value))  # both ends
    return not isinstance(value, dict)


def _short(value: Any) -> str:
    """Return a value as a line of the log has it."""
    if isinstance(value, list):
        return ' to '.join(map(_short, value))
    return f'{value:.5g}' if isinstance(value, float) else str(value).lower()


create = AnalyserNode
