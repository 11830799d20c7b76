"""What anybody may call or say to a node, by services and topics that rclpy makes, ends none."""

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import (
    DescribeParameters,
    GetParameters,
    GetParameterTypes,
    ListParameters,
    SetParameters,
    SetParametersAtomically,
)
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from std_srvs.srv import Trigger
from stranger_node import call_service, stranger_node

from kapitsa_ros.rig import Rig

pytestmark = pytest.mark.xdist_group('processes')
PATIENCE = 120.0
OF_NO_TYPE = Parameter(name='rate', value=ParameterValue(type=99))
SIM_TIME = Parameter(name='use_sim_time', value=ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=True))


@pytest.fixture(scope='module')
def rig() -> Iterator[Rig]:
    with Rig(rate=2.0, composed=True) as rig:
        yield rig


@pytest.fixture
def caller(rig: Rig) -> Iterator[Node]:
    with stranger_node('caller', rig.domain) as node:
        yield node


@pytest.mark.parametrize(
    ('kind', 'service', 'request_fields'),
    [
        (SetParameters, 'set_parameters', {'parameters': [OF_NO_TYPE]}),
        (SetParametersAtomically, 'set_parameters_atomically', {'parameters': [OF_NO_TYPE]}),
        (GetParameters, 'get_parameters', {'names': ['nothing', '']}),
        (GetParameterTypes, 'get_parameter_types', {'names': ['nothing', '']}),
        (DescribeParameters, 'describe_parameters', {'names': ['nothing', 'x' * 1000]}),
        (ListParameters, 'list_parameters', {'prefixes': ['.', 'x' * 1000], 'depth': 2**63}),
    ],
)
def test_calls_with_nonsense_are_answered(
    rig: Rig, caller: Node, kind: Any, service: str, request_fields: dict[str, Any]
) -> None:
    """A type of parameter that does not exist ended the node with a traceback."""
    assert call_service(caller, kind, f'jigsaw/{service}', **request_fields) is not None
    rig.wait_for('jigsaw/pivot', timeout=PATIENCE)
    assert call_service(caller, Trigger, 'jigsaw/pause').success
    assert call_service(caller, Trigger, 'jigsaw/resume').success


def test_a_clock_before_the_rig_began_ends_no_node_that_follows_it(
    rig: Rig, caller: Node, eventually: Callable[[Callable[[], Any]], None]
) -> None:
    """Anybody may have it follow the clock, and rclpy's handler refuses negative times."""
    answer = call_service(caller, SetParameters, 'jigsaw/set_parameters', parameters=[SIM_TIME])
    assert answer.results[0].successful
    publisher = caller.create_publisher(Clock, '/clock', 10)
    early = Clock()
    early.clock.sec = -3
    process = rig.processes['jigsaw']
    eventually(lambda: publisher.publish(early) or process.wait_for_line('refused: a message on /clock', 0.2))
    rig.wait_for('jigsaw/pivot', timeout=PATIENCE)
