"""Services and parameters of simulated time: pause, resume, step and rate, on the node that owns it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from std_srvs.srv import Trigger

from kapitsa_ros.configuration.rig_parameters import RigParameters
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.ros.parameters import declare, declare_quantity
from kapitsa_ros.ros.real_time_pacer import RealTimePacer

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node
    from rclpy.parameter import Parameter


class TimeControl:
    """Decides whether and when the next step is due.

    Services (std_srvs/Trigger) `NODE/pause`, `resume`, `toggle_paused` and `step`. What succeeds is answered with
    a number: of the next step, or after `step` of the step before which time stands still again. What cannot be done is
    answered with a sentence. Parameters: `rate`, and `steps`, both of which may be changed at any time; `start_paused`.

    Parameters
    ----------
    node
        The node that owns time.
    next_step
        Returns the number of the next step.

    """

    def __init__(self, node: Node, *, next_step: Callable[[], StepId]) -> None:
        self.pace = RealTimePacer(declare_quantity(node, RigParameters, 'rate', read_only=False))
        self._steps = declare(node, 'steps', 1, 'steps that the service step makes', 1, 10**6, read_only=False)
        paused = declare(node, 'start_paused', default=False, description='whether time stands still at first')
        self._left: int | None = 0 if paused else None
        """Steps until time stands still; None: it runs."""
        self._next_step = next_step
        node.add_post_set_parameters_callback(self._take_parameters)
        node.create_service(Trigger, '~/pause', self._pause)
        node.create_service(Trigger, '~/resume', self._resume)
        node.create_service(Trigger, '~/toggle_paused', self._toggle)
        node.create_service(Trigger, '~/step', self._step)

    @property
    def stands_still(self) -> bool:
        """Whether no step may be made until a service is called."""
        return self._left == 0

    def count(self, simulated: float) -> None:
        """Note that a step that starts at `simulated` seconds is made now."""
        self.pace.count(simulated)
        if self._left:
            self._left -= 1

    def _take_parameters(self, parameters: list[Parameter]) -> None:
        for parameter in parameters:
            if parameter.name == 'rate':
                self.pace.rate = parameter.value
            elif parameter.name == 'steps':
                self._steps = parameter.value

    def _pause(self, _: Trigger.Request, answer: Trigger.Response) -> Trigger.Response:
        if self.stands_still:
            return _refused(answer, f'paused already, before {self._next_step()}')
        self._left = 0
        return _done(answer, self._next_step())

    def _resume(self, _: Trigger.Request, answer: Trigger.Response) -> Trigger.Response:
        if self._left is None:
            return _refused(answer, 'time runs: there is nothing to resume')
        self._left = None
        self.pace.restart()
        return _done(answer, self._next_step())

    def _toggle(self, request: Trigger.Request, answer: Trigger.Response) -> Trigger.Response:
        return (self._pause if self._left is None else self._resume)(request, answer)

    def _step(self, _: Trigger.Request, answer: Trigger.Response) -> Trigger.Response:
        if not self.stands_still:
            return _refused(answer, 'time runs: pause it, then step')
        self._left = self._steps
        self.pace.restart()
        step_id = self._next_step()
        return _done(answer, StepId(step_id.run, step_id.step + self._steps))


def _done(answer: Trigger.Response, step_id: StepId) -> Trigger.Response:
    answer.success, answer.message = True, str(step_id)
    return answer


def _refused(answer: Trigger.Response, why: str) -> Trigger.Response:
    answer.success, answer.message = False, why
    return answer
