"""Wrong input: one line that names the mend, the right status, nothing left behind."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Kapitsa = Callable[..., Any]


def one_line(answer: Any, status: int, *words: str) -> None:
    assert answer.status == status, answer.err
    assert answer.out == ''
    lines = [line for line in answer.err.splitlines() if line.strip()]
    assert len(lines) == 1, answer.err
    assert 'Traceback' not in answer.err
    for word in words:
        assert word in answer.err


@pytest.mark.parametrize(
    ('arguments', 'words'),
    [
        (['experiment', '--preset', 'perpetuum'], ['--preset', 'ideal']),
        (['experiment', '--instruments', '2026'], ['--instruments', '1997']),
        (['experiment', '--instrument', 'reaction_time'], ['--instrument', 'NAME=VALUE']),
        (['experiment', '--instrument', 'reaction_tim=1'], ['--instrument', 'reaction_tim', 'reaction_time']),
        (['experiment', '--instrument', 'reaction_time=7'], ['--instrument', 'reaction_time', '[0, 1]']),
        (['experiment', '--preset', '/no/such.yaml'], ['--preset', '/no/such.yaml', 'ideal']),
        (['experiment', '--protocol', 'nothing'], ['protocol', '1997']),
        (['experiment', '--length', 'nan'], ['--length', 'finite']),
        (['experiment', '--length', '-0.2'], ['length', 'above 0']),
        (['experiment', '--length', '3 kg'], ['--length', '9.75in']),
        (['experiment', '--damping', '-1'], ['damping']),
        (['experiment', '--damping', '01/s'], ['--damping', 'write it as in 0 1/s']),
        (['experiment', '--restitution', '2'], ['restitution', '[0, 1]']),
        (['experiment', '--seed', '-1'], ['--seed']),
        (['experiment', '--rate', '-1'], ['--rate']),
        (['experiment', '--rate', 'nan'], ['--rate', 'finite']),
        (['experiment', '--bags', 'x' * 300], ['--bags']),
        (['experiment', '--protocol', 'x' * 300], ['protocol']),
        (['experiment', '--length', '('], ['--length']),
        (['experiment', '--length', '9**9**9**9 m'], ['--length']),
        ([], ['kapitsa --help']),
        (['bag'], ['kapitsa bag --help']),
        (['experiment', '--storage', 'tape'], ['--storage', 'mcap']),
        (['experiment', '--compression', 'gzip'], ['--compression', 'zstd', 'none']),
        (['experiment', '--bags', '/proc/nowhere'], ['--bags', '/proc/nowhere']),
        (['analyse', '/nowhere'], ['/nowhere', 'folder of a run']),
        (['replay', '/nowhere'], ['/nowhere', 'folder of a run']),
        (['analyse'], ['BAGS']),
        (['node', 'perpetuum'], ['jigsaw', 'player']),
        (['perpetuate'], ['perpetuate']),
        (['bag', 'info', '/nowhere'], ['/nowhere']),
        (['serve', '--class', '/no/such.yaml'], ['/no/such.yaml', 'cannot be read']),
        (['replay', 'A', '--port', '8097'], ['--port', '--web']),
    ],
    ids=lambda value: ' '.join(value) if isinstance(value, list) else None,
)
def test_one_line_and_status_2(kapitsa: Kapitsa, arguments: list[str], words: list[str]) -> None:
    one_line(kapitsa(*arguments), 2, *words)


def test_a_speed_the_jigsaw_cannot_do(kapitsa: Kapitsa, tmp_path: Path) -> None:
    protocol = tmp_path / 'fast.yaml'
    protocol.write_text('speeds: [2240, 60000]')
    one_line(
        kapitsa('experiment', '--protocol', protocol, '--bags', tmp_path / 'A'),
        2,
        '60000 RPM',
        '5000 RPM',
        '--protocol',
    )
    assert not (tmp_path / 'A').exists()


def test_existing_runs(kapitsa: Kapitsa, tmp_path: Path) -> None:
    (tmp_path / 'run_02_2640rpm').mkdir()
    one_line(kapitsa('experiment', '--bags', tmp_path), 2, 'run_02_2640rpm exists', '--bags')
    assert [path.name for path in tmp_path.iterdir()] == ['run_02_2640rpm']


@pytest.mark.parametrize('domain', ['seven', '-1', '500'])
def test_a_domain_that_is_none(kapitsa: Kapitsa, tmp_path: Path, domain: str) -> None:
    one_line(kapitsa('experiment', '--bags', tmp_path, env={'ROS_DOMAIN_ID': domain}), 2, 'ROS_DOMAIN_ID', domain)


@pytest.mark.skipif(os.geteuid() == 0 and not Path('/proc').is_dir(), reason='root writes everywhere')
def test_a_folder_that_is_a_file(kapitsa: Kapitsa, tmp_path: Path) -> None:
    (tmp_path / 'file').write_text('')
    one_line(kapitsa('experiment', '--bags', tmp_path / 'file'), 2, '--bags')


@pytest.mark.parametrize(
    ('role', 'arguments', 'words'),
    [
        ('pendulum', ['-p', 'length:=1'], ['length', '1.0']),
        ('pendulum', ['-p', 'length:=-1.0'], ['length']),
        ('pendulum', ['-p', 'length:=.nan'], ['length']),
        ('pendulum', ['-p', 'restitution:=1.5'], ['restitution', '[0.0, 1.0]']),
        ('jigsaw', ['-p', 'rod_ratio:=0.5'], ['rod_ratio']),
        ('jigsaw', ['-p', 'in_flight:=0'], ['in_flight']),
        ('jigsaw', ['-p', 'sample_rate:=999.0'], ['sample_rate']),
        ('stopwatch', ['-p', 'swings:=0'], ['swings']),
        ('strobe', ['-p', 'seed:=many'], ['seed']),
        ('operator', ['-p', 'protocol:=nothing'], ['protocol', '1997']),
        ('recorder', ['-p', 'storage:=tape'], ['storage', 'mcap']),
        ('recorder', ['-p', 'compression:=gzip'], ['compression', 'none']),
        ('player', [], ['bags']),
        ('player', ['-p', 'bags:=[/nowhere]'], ['/nowhere']),
        ('jigsaw', ['-p', 'rate:=fast'], ['rate']),
        ('pendulum', ['--params-file', '/nowhere.yaml'], []),
        ('pendulum', ['--bogus'], ['unknown', '--bogus']),
        ('pendulum', ['-p', 'expect:=[nobody]'], ['expect', 'nobody']),
        ('pendulum', ['-p', 'expect:=[observer]'], ['expect']),
    ],
)
def test_a_wrong_parameter(kapitsa: Kapitsa, role: str, arguments: list[str], words: list[str]) -> None:
    one_line(kapitsa('node', role, '--ros-args', *arguments, env={'ROS_DOMAIN_ID': '99'}), 2, role, *words)


@pytest.mark.parametrize('role', ['strobe', 'composed'])
def test_a_node_of_another_name(kapitsa: Kapitsa, role: str) -> None:
    """Nobody would find it, and all would wait."""
    answer = kapitsa('node', role, '--ros-args', '-r', '__node:=lamp', env={'ROS_DOMAIN_ID': '99'})
    one_line(answer, 2, 'named lamp', 'has to be', 'namespace')


def test_an_argument_that_is_none_of_ros(kapitsa: Kapitsa) -> None:
    one_line(kapitsa('node', 'jigsaw', 'rate:=1'), 2, 'jigsaw', 'rate:=1', '--ros-args -p')
    one_line(kapitsa('node', 'jigsaw', '--ros-args', '-p', 'rate:=1.0', '--', 'extra'), 2, 'jigsaw', 'extra')


@pytest.mark.parametrize('arguments', [['-p', 'rate'], ['-r', 'foo'], ['--log-level', 'loud'], ['-p']])
def test_an_argument_that_rcl_cannot_parse(kapitsa: Kapitsa, arguments: list[str]) -> None:
    """It says so in a line of its own, before there is a log."""
    answer = kapitsa('node', 'jigsaw', '--ros-args', *arguments)
    said = answer.err.splitlines()[-1]
    assert answer.status == 2
    assert said.startswith('jigsaw: error: ROS arguments: ')
    assert arguments[-1] in said
    assert '.c:' not in said


def test_a_node_says_what_it_is(kapitsa: Kapitsa) -> None:
    answer = kapitsa('node', 'jigsaw', '--help')
    assert answer.status == 0
    assert answer.out.startswith('usage: jigsaw [--ros-args')
    assert 'owns time' in answer.out


def test_a_params_file_with_a_wrong_type(kapitsa: Kapitsa, tmp_path: Path) -> None:
    path = tmp_path / 'mine.yaml'
    path.write_text('/**:\n  ros__parameters:\n    length: long\n')
    answer = kapitsa('node', 'pendulum', '--ros-args', '--params-file', path, env={'ROS_DOMAIN_ID': '99'})
    one_line(answer, 2, 'pendulum', 'length', 'double')
