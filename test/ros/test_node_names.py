"""The names of nodes, of which the graph tells a moment after their topics."""

from types import SimpleNamespace

import pytest

from kapitsa_ros.ros import node_names
from kapitsa_ros.ros.node_names import NAMELESS, UNKNOWN, wait_for_names


def test_a_node_without_a_name_is_called_that() -> None:
    ends = [SimpleNamespace(node_name=name) for name in ('strobe', UNKNOWN, 'analyser')]
    assert node_names.node_names(ends) == [NAMELESS, 'analyser', 'strobe']


def test_who_is_at_fault_is_named_as_soon_as_the_graph_does() -> None:
    looks = iter([[NAMELESS, 'strobe'], [NAMELESS, 'strobe'], ['passer_by', 'strobe'], ['too late']])
    assert wait_for_names(lambda: next(looks)) == ['passer_by', 'strobe']


def test_who_never_tells_its_name_is_not_waited_for_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(node_names, 'NAMING', 0.05)
    assert wait_for_names(lambda: [NAMELESS]) == [NAMELESS]
    assert wait_for_names(list) == []
