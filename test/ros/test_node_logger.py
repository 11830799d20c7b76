"""The logger of a node says its lines as that of rclpy does, and looks at no module for it."""

import inspect

import pytest

from kapitsa_ros.ros.node_logger import NodeLogger


def refuse_to_look(*_: object) -> None:
    raise AssertionError('a hundred milliseconds in each node')


def test_a_line_has_its_level_and_whose_it_is(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(inspect, 'getmodule', refuse_to_look)
    logger = NodeLogger('strobe')
    logger.info('joins domain 7')
    logger.warning('waits')
    logger.debug('is not said')
    joined, waits = capfd.readouterr().err.splitlines()
    assert joined.startswith('[INFO] ')
    assert joined.endswith(' [strobe]: joins domain 7')
    assert waits.startswith('[WARN] ')
    assert waits.endswith(' [strobe]: waits')
