"""Pause, step, pace and reset of a running rig: each call returns once all topics have said what it leads to."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kapitsa_ros.network.registry import COMMAND
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.rig.errors import RigError, UsageError

if TYPE_CHECKING:
    from collections.abc import Callable

    from kapitsa_ros.ros.rig_client import RigClient


class SimulationControl:
    """Controls the node that owns time, and follows the topics to the step that a call leads to.

    Parameters
    ----------
    client
        Calls the node, and knows what each topic has said.
    wait
        Returns what its first argument does, once that is not None; the second says in words what is waited for.

    Raises
    ------
    RigError
        From any method: the jigsaw refuses.
    UsageError
        From any method that takes a value: it is none that the jigsaw takes.

    """

    def __init__(self, client: RigClient, wait: Callable[[Callable[[], Any], str], Any]) -> None:
        self._client, self._await = client, wait

    def pause(self) -> None:
        """Let time stand still; when this returns, the last step has come through."""
        self._wait_for_step_before(self._call('pause'))

    def resume(self) -> None:
        """Let time run again."""
        self._call('resume')

    def step(self, count: int) -> None:
        """Make some steps of a paused rig; when this returns, they have come through."""
        self._set(steps=count)
        self._wait_for_step_before(self._call('step'))

    def set_rate(self, rate: float) -> None:
        """Change simulated over wall seconds; 0: as fast as it can."""
        self._set(rate=rate)

    def reset(self) -> None:
        """End the run under way and open the next; when this returns, nothing but the result is left of the earlier."""
        run = self._call('reset').run
        self._await(lambda: self._has_opened(run) or None, f'run {run}')
        self._client.forget_before(run)

    def _has_opened(self, run: int) -> bool:
        seen = dict(self._client.seen)
        commanded = seen.pop(COMMAND.name)
        return (
            commanded is not None
            and commanded.run >= run
            and all(step_id is not None and (step_id.run, step_id.end) >= (run - 1, True) for step_id in seen.values())
        )

    def _wait_for_step_before(self, next_step: StepId) -> None:
        def has_come() -> bool | None:
            seen = list(self._client.seen.values())
            return all(step_id is not None and _is_through(step_id, next_step) for step_id in seen) or None

        if next_step.step:
            self._await(has_come, f'the step before {next_step}')

    def _call(self, service: str) -> StepId:
        """Call a service; return the number in its answer, or raise what else it says."""
        answer = self._answer(self._served().call(service), f'an answer of jigsaw/{service}')
        if not answer.success:
            raise RigError('jigsaw/{service}: {answer}', service=service, answer=answer.message)
        return StepId.parse(answer.message)

    def _set(self, **values: float) -> None:
        for result in self._answer(self._served().set_parameters(**values), 'an answer of the jigsaw').results:
            if not result.successful:
                raise UsageError('jigsaw: {why}', why=result.reason)

    def _answer(self, future: Any, what: str) -> Any:
        self._await(lambda: future.done() or None, what)
        return future.result()

    def _served(self) -> RigClient:
        self._await(lambda: self._client.is_served() or None, 'a jigsaw that can be called')
        return self._client


def _is_through(step_id: StepId, next_step: StepId) -> bool:
    """Whether a topic that is at a number has said all that comes before a step."""
    return (step_id.run, step_id.step) >= (next_step.run, next_step.step - 1) or (
        step_id.end and step_id.run == next_step.run
    )
