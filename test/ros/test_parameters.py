"""What `ros2 param describe` says is derived from the schema."""

from pathlib import Path

import pytest
from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter

from kapitsa_ros.configuration.rig_parameters import RigParameters
from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
from kapitsa_ros.physics.jigsaw_parameters import JigsawParameters
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.rig.domain import reserved_domain
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.rig.parameters_yaml import parameters_yaml
from kapitsa_ros.rig.setup import Replay, Setup, parameters, replay_parameters
from kapitsa_ros.ros.arguments import typed_parameters
from kapitsa_ros.ros.errors import SettingError
from kapitsa_ros.ros.parameters import declare, declare_quantity, declare_set, unknown_parameters

pytestmark = pytest.mark.xdist_group('processes')


@pytest.fixture(scope='module')
def context():
    with reserved_domain() as domain:
        context = Context()
        with on_loopback():  # the first node of a process opens DDS, for good
            context.init(domain_id=domain)
            Node('first', context=context).destroy_node()
        yield context
        context.try_shutdown()


@pytest.fixture
def node_with(context):
    """Return a function that makes a node which was given parameters."""
    nodes = []

    def make(**given):
        overrides = [Parameter(name, value=value) for name, value in given.items()]
        nodes.append(Node('declaring', context=context, parameter_overrides=overrides))
        return nodes[-1]

    yield make
    for node in nodes:
        node.destroy_node()


def test_a_set_is_declared_with_defaults_ranges_and_meanings(node_with):
    node = node_with(length=0.3)
    assert declare_set(node, Plant) == Plant(length=0.3)
    described = {name: node.describe_parameter(name) for name in ('length', 'gravity', 'restitution')}
    assert described['length'].description == 'L: length of the uniform rod, m'
    (length,), (restitution,) = (described[name].floating_point_range for name in ('length', 'restitution'))
    assert (length.from_value, length.to_value) == (1e-6, 1e3)
    assert (restitution.from_value, restitution.to_value) == (0.0, 1.0)
    assert all(parameter.read_only for parameter in described.values())
    assert all(parameter.description.isascii() for parameter in described.values())


def test_what_all_nodes_of_a_rig_or_a_replay_are_given_is_known_to_each(node_with):
    for given in (parameters(Setup()), replay_parameters([Path('run')], Replay())):
        assert unknown_parameters(node_with(**given)) == []
        assert len(unknown_parameters(node_with(**given, lenght=0.3))) == 1


def test_what_was_typed_for_one_node_and_is_another_role_s_is_told(node_with):
    node = node_with(amplitude=0.02, length=0.3)
    declare_set(node, Plant, 'length')
    assert unknown_parameters(node) == []
    told = unknown_parameters(node, frozenset({'amplitude', 'length'}))
    assert told == ['parameter amplitude is that of another role: it is not used here']
    arguments = [
        'pendulum',
        '--ros-args',
        '-p',
        'amplitude:=0.02',
        '--params-file',
        'x',
        '--param',
        'pendulum:length:=1',
    ]
    assert typed_parameters(arguments) == {'amplitude', 'length'}


def test_a_number_is_taken_for_the_text_that_was_typed_and_a_text_for_a_list_of_one(node_with):
    node = node_with(protocol=1997, bags='run', other=True)
    assert declare(node, 'protocol', 'manual', 'what is done') == '1997'
    assert declare(node, 'bags', [''], 'folders') == ['run']
    with pytest.raises(SettingError, match='other must be a string'):
        declare(node, 'other', 'text', 'a text')


def test_fields_that_are_not_named_are_not_declared(node_with):
    node = node_with()
    declare_set(node, Plant, 'amplitude')
    assert node.has_parameter('amplitude')
    assert not node.has_parameter('length')


def test_whole_numbers_have_whole_ranges(node_with):
    node = node_with(seed=7)
    assert declare_quantity(node, RigParameters, 'seed') == 7
    (span,) = node.describe_parameter('seed').integer_range
    assert (span.from_value, span.to_value) == (0, 2**63 - 1)


def test_some_may_be_changed(node_with):
    node = node_with()
    declare_quantity(node, RigParameters, 'rate', read_only=False)
    assert node.set_parameters([Parameter('rate', value=2.0)])[0].successful
    assert not node.set_parameters([Parameter('rate', value=-1.0)])[0].successful


@pytest.mark.parametrize(
    ('kind', 'given', 'complaint'),
    [
        (Plant, {'length': 1}, 'length must be a double: write 1.0 for 1'),
        (Plant, {'length': -1.0}, 'length is -1.0'),
        (Plant, {'clearance': 0.5}, 'below failure_clearance'),
        (JigsawParameters, {'rod_ratio': 0.5}, 'rod_ratio is 0.5: it must be above 1'),
        (StopwatchSettings, {'reaction_time': float('nan')}, 'reaction_time is nan'),
    ],
)
def test_what_cannot_be_is_an_error_of_the_setting(node_with, kind, given, complaint):
    with pytest.raises(SettingError, match=f'^parameter {complaint}' if 'below' not in complaint else complaint):
        declare_set(node_with(**given), kind)


def test_texts_reach_a_node_as_texts_and_numbers_as_numbers(context, tmp_path):
    """A folder for bags may be named n, which rcl takes for a truth value and PyYAML does not."""
    texts = [
        'n',
        'Y',
        '1e3',
        'inf',
        'nan',
        '0x1F',
        '007',
        'on',
        'null',
        '',
        ' a: #b',
        "it's",
        'Стол',
        'a\nb',
        'x ' * 99,
    ]
    given = {'texts': texts, 'whole': 3, 'number': 1e-5, 'flag': True, 'numbers': [1.0, 2.5]}
    given |= {f'text_{place}': text for place, text in enumerate(texts)}
    file = tmp_path / 'parameters.yaml'
    file.write_text(parameters_yaml(given), encoding='utf-8')
    node = Node(
        'reader',
        context=context,
        cli_args=['--ros-args', '--params-file', str(file)],
        automatically_declare_parameters_from_overrides=True,
        start_parameter_services=False,
    )
    found = {name: node.get_parameter(name).value for name in given}
    node.destroy_node()
    assert {name: list(value) if name.endswith('s') else value for name, value in found.items()} == given


def test_a_list_may_be_empty_and_nothing_else(node_with):
    """Of `-p NAME:=[]` rcl makes a parameter without a value."""
    node = node_with(bags=None, protocol=None)
    assert declare(node, 'bags', [''], 'folders') == []
    with pytest.raises(SettingError, match='parameter protocol is empty: it must be a string'):
        declare(node, 'protocol', '1997', 'name')
