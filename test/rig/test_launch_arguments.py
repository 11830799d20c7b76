"""What launch files hand to the rig: text is checked before a node starts, and a failed node ends the launch."""

import ast
import contextlib
import os
import re
import shutil
import subprocess
from dataclasses import fields
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import yaml

from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.rig.errors import RigError, UsageError
from kapitsa_ros.rig.launch_arguments import (
    PLANT_ARGUMENTS,
    drawn_from,
    end_with_failed,
    executables,
    given_to_viewer,
    make_ready,
    misspelt,
    namespace_of,
    node_options,
    replay_from,
    rig_from,
)
from kapitsa_ros.rig.preflight import make_writable
from kapitsa_ros.rig.setup import Setup

CHECKOUT = Path(__file__).parents[2]
PLAYED = {'rate': '1.0', 'start': '0.0', 'end': '', 'loop': 'false', 'start_paused': 'false'}
SAID = {
    'preset': 'bearing', 'plant': '', 'instruments': '1997', 'instrument': '', 'protocol': '1997', 'rate': '2',
    'seed': '7', 'bags': 'runs', 'compression': 'none',
}  # fmt: skip


def ready(said: dict[str, str]) -> Setup:
    setup = rig_from(said)
    make_ready(setup)
    return setup


def test_text_becomes_a_rig(tmp_path: Path) -> None:
    setup = rig_from(SAID | {'bags': str(tmp_path / 'new')})
    assert (setup.plant.coulomb, setup.rate, setup.seed, setup.compression) == (0.05, 2.0, 7, 'none')
    assert setup.bags == tmp_path / 'new'
    assert not setup.bags.exists()  # other arguments may still be refused
    make_ready(setup)
    assert setup.bags.is_dir()


@pytest.mark.parametrize(
    ('name', 'value', 'said'),
    [
        ('rate', 'x', 'rate:=x: '),
        ('rate', '-1', 'rate:=-1: '),
        ('rate', 'nan', 'rate:=nan: '),
        ('seed', '-1', 'seed:=-1: '),
        ('seed', '1.5', 'seed:=1.5: '),
        ('preset', 'nope', "no preset 'nope'"),
        ('protocol', '/no/such', "no protocol '/no/such'"),
        ('bags', '/proc/x', 'bags:=/proc/x: '),
    ],
)
def test_what_cannot_be_is_refused_in_words_of_launch(tmp_path: Path, name: str, value: str, said: str) -> None:
    with pytest.raises(UsageError, match=re.escape(said)) as error:
        ready(SAID | {'bags': str(tmp_path / 'new'), name: value})
    assert '--' not in str(error.value)
    assert not (tmp_path / 'new').exists()


def test_parameters_in_a_file_are_those_of_the_rig(tmp_path: Path) -> None:
    """What a launch derives of them, such as the drawn rod and the folder that is made, is that of the nodes."""
    path = tmp_path / 'mine.yaml'
    said = SAID | {'bags': str(tmp_path / 'not_this'), 'length': '1.0', 'params_file': str(path)}
    with pytest.raises(UsageError, match=r'^params_file:=.*mine.yaml: there is no such file'):
        rig_from(said)
    path.write_text('rate: 5.0\n', encoding='utf-8')
    with pytest.raises(UsageError, match=r'^params_file:=.*mine.yaml: below the name of a node'):
        rig_from(said)
    given = {
        '/**': {'length': 0.5, 'seed': 9, 'reaction_time': 0.1, 'expect': ['jigsaw']},
        '/strobe': {'seed': 3},
        'recorder': {'bags': str(tmp_path / 'new'), 'compression': 'zstd'},
        'operator': {'protocol': 'manual'},
    }
    path.write_text(yaml.safe_dump({node: {'ros__parameters': own} for node, own in given.items()}), encoding='utf-8')
    setup = ready(said)
    assert (setup.plant.length, setup.seed, setup.protocol, setup.compression) == (0.5, 9, 'manual', 'zstd')
    assert (tmp_path / 'new').is_dir()
    assert not (tmp_path / 'not_this').exists()


@pytest.mark.parametrize(('protocol', 'run'), [('1997', 'run_02_2640rpm'), ('manual', 'run_01_0rpm')])
def test_a_run_that_is_there_is_refused_before_the_start(tmp_path: Path, protocol: str, run: str) -> None:
    (tmp_path / run).mkdir()
    with pytest.raises(UsageError, match=f'{run} exists: .* another bags:='):
        ready(SAID | {'bags': str(tmp_path), 'protocol': protocol})


def test_a_parameter_of_the_plant_is_an_argument_of_its_own(tmp_path: Path) -> None:
    said = SAID | {'bags': str(tmp_path / 'new'), 'plant': 'length=10in damping=0.2', 'length': '12in', 'clearance': ''}
    plant = rig_from(said).plant
    assert (plant.length, plant.damping) == (pytest.approx(0.3048), 0.2)
    assert set(PLANT_ARGUMENTS) == {item.name for item in fields(Plant)}
    with pytest.raises(UsageError, match='length is -1'):
        rig_from(said | {'length': '-1', 'bags': str(tmp_path / 'other')})


def test_what_every_node_of_a_launch_is_given(tmp_path: Path) -> None:
    context = SimpleNamespace(launch_configurations={})
    said = {'namespace': '', 'log_level': '', 'params_file': ''}
    plain = node_options(said, context, {'rate': 1.0})
    assert (plain['namespace'], plain['parameters'], plain['ros_arguments']) == (None, [{'rate': 1.0}], [])
    assert plain['arguments'] == ['--parent-pid', str(os.getpid())]
    file = tmp_path / 'mine.yaml'
    full = node_options({'namespace': 'lab', 'log_level': 'debug', 'params_file': str(file)}, context, {'rate': 1.0})
    assert (full['namespace'], full['parameters']) == ('lab', [{'rate': 1.0}, str(file)])
    assert full['ros_arguments'] == ['--log-level', 'debug']
    # A debugger in between would be taken for a launcher that is gone.
    context.launch_configurations['launch-prefix'] = 'gdb --args'
    assert node_options(said, context, {})['arguments'] == []


@pytest.mark.parametrize(('namespace', 'is_one'), [
    ('/', True), ('/lab', True), ('lab/left_2', True),
    ('a b', False), ('//', False), ('lab/', False), ('1lab', False), ('~', False), ('λ', False), ('lab\n', False),
])  # fmt: skip
def test_what_is_no_namespace_is_refused_before_a_node_says_so(namespace: str, *, is_one: bool) -> None:
    said = {'namespace': namespace, 'log_level': '', 'params_file': ''}
    with contextlib.nullcontext() if is_one else pytest.raises(UsageError, match=r'^namespace:=.*as in lab'):
        assert node_options(said, SimpleNamespace(launch_configurations={}), {})['namespace'] == namespace


@pytest.mark.parametrize(('pushed', 'given', 'together'), [
    ('', '', ''), ('', 'lab', '/lab'), ('', '/lab', '/lab'), ('/hall', '', '/hall'), ('/hall', 'lab', '/hall/lab'),
    ('/hall', '/lab', '/lab'),
])  # fmt: skip
def test_a_namespace_is_below_that_of_who_includes_the_launch(pushed: str, given: str, together: str) -> None:
    context = SimpleNamespace(launch_configurations={'ros_namespace': pushed} if pushed else {})
    assert namespace_of({'namespace': given}, context) == together


@pytest.mark.parametrize(('said', 'count'), [('true', 1), ('True', 1), ('false', 2), ('False', 2)])
def test_truth_is_written_as_in_launch_files_or_as_in_python(said: str, count: int) -> None:
    options = node_options({'namespace': '', 'log_level': ''}, SimpleNamespace(launch_configurations={}), {})
    assert len(executables(('jigsaw', 'strobe'), {'composed': said}, options)) == count


def test_a_speed_no_jigsaw_turns_at_is_refused(tmp_path: Path) -> None:
    fast = tmp_path / 'fast.yaml'
    fast.write_text('speeds: [6000 rpm]\n', encoding='utf-8')
    with pytest.raises(UsageError, match='protocol:= wants 6000 RPM'):
        ready(SAID | {'bags': str(tmp_path / 'new'), 'protocol': str(fast)})


def test_a_value_that_looks_like_an_option_stays_as_it_was_given(tmp_path: Path) -> None:
    """An error names the option it is about; its text is nothing to search for options."""
    folder = tmp_path / 'x--bags y: z'
    folder.mkdir()
    with pytest.raises(UsageError, match=re.escape(f'bags:={folder}: no run is there')):
        replay_from(PLAYED | {'bags': str(folder), 'rate': '1.0'})
    with pytest.raises(UsageError, match=re.escape('--bags /proc/--rate x: y: cannot be made')) as error:
        make_writable(Path('/proc/--rate x: y'))
    assert error.value.option == 'bags'
    assert error.value.in_launch().startswith('bags:=/proc/--rate x: y: cannot be made')


def test_replay_takes_a_folder_of_runs_or_one_run() -> None:
    bags = CHECKOUT / 'bags'
    runs = sorted(str(path) for path in bags.glob('run_*'))
    assert replay_from(PLAYED | {'bags': str(bags), 'rate': '0'})['bags'] == runs
    one = replay_from(PLAYED | {'bags': runs[1], 'rate': '2', 'start': '3', 'end': '5', 'loop': 'true'})
    assert one['bags'] == [runs[1]]
    assert (one['rate'], one['start'], one['end'], one['loop'], one['start_paused']) == (2.0, 3.0, 5.0, True, False)
    with pytest.raises(UsageError, match='the end, 2 s, is not after the start, 3 s'):
        replay_from(PLAYED | {'bags': runs[1], 'start': '3', 'end': '2'})


def test_replay_refuses_a_folder_without_runs_and_takes_a_run_without_metadata(tmp_path: Path) -> None:
    said = PLAYED | {'bags': str(tmp_path), 'rate': '1.0'}
    with pytest.raises(UsageError, match=f'bags:={tmp_path}: no run is there'):
        replay_from(said)
    shutil.copytree(CHECKOUT / 'bags' / 'run_01_2240rpm', tmp_path / 'killed')
    (tmp_path / 'killed' / 'metadata.yaml').unlink()
    assert replay_from(said)['bags'] == [str(tmp_path / 'killed')]


def test_only_a_failure_nobody_asked_for_ends_the_launch() -> None:
    def ended(returncode: int, *, stopping: bool) -> tuple[Any, Any]:
        return SimpleNamespace(returncode=returncode, process_name='jigsaw-1'), SimpleNamespace(is_shutdown=stopping)

    end_with_failed(*ended(0, stopping=False))
    end_with_failed(*ended(-2, stopping=True))
    with pytest.raises(RigError, match='jigsaw-1 has failed with status 2'):
        end_with_failed(*ended(2, stopping=False))


def test_an_included_viewer_is_given_all_its_arguments() -> None:
    """What it is not given it takes from the file that includes it: the folder of a rig's bags for that of a replay."""
    tree = ast.parse((CHECKOUT / 'launch' / 'viewer.launch.py').read_text(encoding='utf-8'))
    [declared] = [
        node.value for node in tree.body if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == 'ARGUMENTS'
    ]
    assert isinstance(declared, ast.Dict)
    plant = Plant(length=0.3)
    given = given_to_viewer({'viewer': 'foxglove', 'namespace': 'lab', 'bags': 'runs'}, plant)
    assert list(given) == [ast.literal_eval(key) for key in declared.keys if key is not None]
    assert drawn_from(given) == (plant, [])


def test_what_a_viewer_draws_is_read_as_for_a_rig() -> None:
    said = {'length': '12in', 'amplitude': '0.01', 'bags': str(CHECKOUT / 'bags' / 'run_01_2240rpm')}
    plant, bags = drawn_from(said)
    assert (plant.length, plant.amplitude) == (pytest.approx(0.3048), 0.01)
    assert bags == [said['bags']]
    with pytest.raises(UsageError, match='bags:=/nowhere: no run is there'):
        drawn_from(said | {'bags': '/nowhere'})
    with pytest.raises(UsageError, match='length'):
        drawn_from(said | {'length': 'x'})


@pytest.mark.parametrize('file', ['rig.launch.py', 'replay.launch.py'])
def test_every_launch_argument_is_in_the_readme(file: str) -> None:
    tree = ast.parse((CHECKOUT / 'launch' / file).read_text(encoding='utf-8'))
    tables = [
        node.value for node in tree.body if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == 'ARGUMENTS'
    ]
    names = [ast.literal_eval(key) for table in tables if isinstance(table, ast.Dict) for key in table.keys if key]
    readme = (CHECKOUT / 'README.md').read_text(encoding='utf-8')
    said = next(line for line in readme.splitlines() if line.startswith(f'| `{file}`'))
    assert re.findall(r'`(\w+):=', said) == names
    assert names


@pytest.mark.skipif(shutil.which('ros2') is None, reason='needs ros2cli, which PyPI has not')
@pytest.mark.xdist_group('processes')
def test_ros2_launch_carries_out_and_refuses_to_repeat(tmp_path: Path, domain: int) -> None:
    """The real tools, where they are: `colcon test` on a ROS machine."""
    command = ['ros2', 'launch', 'kapitsa_ros', 'rig.launch.py', 'rate:=0', f'bags:={tmp_path}']
    environment = os.environ | {'ROS_DOMAIN_ID': str(domain)}
    first, second = (
        subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120, check=False)
        for _ in range(2)
    )
    assert first.returncode == 0, first.stdout + first.stderr
    assert first.stdout.count('process has finished cleanly') == 7
    assert 'experiment: omega_crit_rpm' in first.stdout + first.stderr
    assert second.returncode == 1
    assert 'run_01_2240rpm exists' in second.stdout + second.stderr
    assert 'process started' not in second.stdout


def test_an_argument_that_is_none_but_much_like_one_is_named() -> None:
    """launch takes it without a word, and the rig has the length that it has without."""
    known = {*PLANT_ARGUMENTS, *SAID, 'namespace'}
    given = {*known, 'lenght', 'robot', 'ros_namespace', 'launch-prefix'}
    assert misspelt(given, known) == ['lenght:= is unknown, and not used: length:= may be meant']
