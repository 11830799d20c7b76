"""Pause, resume, step and rate, served to a node that only keeps what is declared."""

from types import SimpleNamespace

import pytest
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.ros.time_control import TimeControl


class Node:
    """Declares parameters, at their defaults where none is given, and calls back what a real node would."""

    def __init__(self, given: dict[str, bool]) -> None:
        self.services, self.set_parameters, self.given = {}, None, given

    def declare_parameter(self, name, default, descriptor):
        assert descriptor.read_only == (name == 'start_paused')
        return SimpleNamespace(value=self.given.get(name, default))

    def add_post_set_parameters_callback(self, callback) -> None:
        self.set_parameters = callback

    def create_service(self, kind, name, callback) -> None:
        assert kind is Trigger
        self.services[name] = callback


class Lab:
    """A node that makes steps while it may."""

    def __init__(self, **given: bool) -> None:
        self.node, self.next = Node(given), StepId(1, 0)
        self.time = TimeControl(self.node, next_step=lambda: self.next)

    def call(self, name: str) -> tuple[bool, str]:
        answer = self.node.services[f'~/{name}'](Trigger.Request(), Trigger.Response())
        return answer.success, answer.message

    def make_steps(self, most: int) -> int:
        """Make steps until time stands still, and return how many they were."""
        for made in range(most):
            if self.time.stands_still:
                return made
            self.time.count(0.1 * self.next.step)
            self.next = StepId(self.next.run, self.next.step + 1)
        return most


@pytest.fixture
def lab() -> Lab:
    return Lab()


def test_time_runs_until_it_is_paused_and_again_once_it_is_resumed(lab: Lab) -> None:
    assert lab.make_steps(5) == 5
    assert lab.call('pause') == (True, 'run 1 step 5')
    assert lab.make_steps(5) == 0
    assert lab.call('resume') == (True, 'run 1 step 5')
    assert lab.make_steps(5) == 5


def test_what_cannot_be_done_is_answered_with_a_sentence(lab: Lab) -> None:
    assert lab.call('resume') == (False, 'time runs: there is nothing to resume')
    assert lab.call('step') == (False, 'time runs: pause it, then step')
    lab.call('pause')
    assert lab.call('pause') == (False, 'paused already, before run 1 step 0')
    assert lab.make_steps(5) == 0


def test_as_many_steps_are_made_as_the_parameter_says(lab: Lab) -> None:
    lab.call('pause')
    assert lab.call('step') == (True, 'run 1 step 1')
    assert lab.make_steps(5) == 1
    lab.node.set_parameters([Parameter('steps', value=3)])
    assert lab.call('step') == (True, 'run 1 step 4')
    assert lab.make_steps(2) == 2
    assert lab.call('step') == (False, 'time runs: pause it, then step')
    assert lab.make_steps(5) == 1
    assert lab.next == StepId(1, 4)


def test_one_service_pauses_and_resumes(lab: Lab) -> None:
    assert lab.call('toggle_paused') == (True, 'run 1 step 0')
    assert lab.make_steps(5) == 0
    assert lab.call('toggle_paused') == (True, 'run 1 step 0')
    assert lab.make_steps(5) == 5


def test_time_stands_still_at_first_where_that_is_asked() -> None:
    lab = Lab(start_paused=True)
    assert lab.make_steps(5) == 0
    lab.call('resume')
    assert lab.make_steps(5) == 5


def test_the_rate_is_changed_and_nothing_else(lab: Lab) -> None:
    lab.node.set_parameters([Parameter('rate', value=2.5), Parameter('use_sim_time', value=False)])
    assert lab.time.pace.rate == 2.5
