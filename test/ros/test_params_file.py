"""Files of parameters: what rcl takes is taken, what it would misunderstand is refused in one line."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

from kapitsa_ros.ros.errors import SettingError
from kapitsa_ros.ros.params_file import read_params_file


def written(folder: Path, text: str) -> Path:
    path = folder / 'mine.yaml'
    path.write_text(text, encoding='utf-8')
    return path


def test_what_launch_ros_writes_of_a_list_is_read(tmp_path: Path) -> None:
    """It makes a tuple of each list and writes it with the tag of one; rcl looks at no tags."""
    text = yaml.dump({'/**': {'ros__parameters': {'expect': ('jigsaw', 'strobe'), 'rate': 1.0}}})
    assert '!!python/tuple' in text
    assert read_params_file(written(tmp_path, text)) == {'/**': {'expect': ['jigsaw', 'strobe'], 'rate': 1.0}}


def test_a_node_takes_what_launch_ros_writes(kapitsa: Callable[..., Any], tmp_path: Path) -> None:
    bag = tmp_path / 'no_bag'
    path = written(tmp_path, yaml.dump({'/**': {'ros__parameters': {'bags': (str(bag),)}}}))
    answer = kapitsa('node', 'player', '--ros-args', '--params-file', path, env={'ROS_DOMAIN_ID': '99'})
    assert answer.err.startswith(f'player: error: parameter bags: {bag}')  # it looks for the run that the file names
    assert answer.err.count('\n') == 1


def test_nodes_stand_below_their_namespaces(tmp_path: Path) -> None:
    text = 'lab:\n  jigsaw:\n    ros__parameters: {rate: 2.0}\n/strobe:\n  ros__parameters: {seed: 3}\n'
    assert read_params_file(written(tmp_path, text)) == {'lab/jigsaw': {'rate': 2.0}, '/strobe': {'seed': 3}}


@pytest.mark.parametrize(
    'text', ['jigsaw:\n  rate: 50.0\n', 'rate: 5\n', '/**:\n  ros__parameters: 5\n', '/**:\n  ros__parameters:\n']
)
def test_names_and_values_in_the_wrong_place_are_refused(tmp_path: Path, text: str) -> None:
    path = written(tmp_path, text)
    with pytest.raises(SettingError, match=rf'^{re.escape(str(path))}: below the name of a node, .*ros__parameters'):
        read_params_file(path)


@pytest.mark.parametrize('text', ['', '# nothing\n', '[1]\n', '{', 'a: 1\na: 2\n'])
def test_what_holds_no_parameters_is_refused(tmp_path: Path, text: str) -> None:
    with pytest.raises(SettingError, match=r'mine\.yaml'):
        read_params_file(written(tmp_path, text))
