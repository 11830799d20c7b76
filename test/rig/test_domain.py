"""A domain is free where nobody else is."""

import socket
from pathlib import Path

import pytest

from kapitsa_ros.rig.domain import reserved_domain
from kapitsa_ros.rig.errors import RigError, UsageError
from kapitsa_ros.rig.session import run_experiment
from kapitsa_ros.rig.setup import Setup


def test_a_domain_in_which_a_participant_is_open_is_not_free() -> None:
    """Nodes whose rig was killed still run for a moment, and other ROS programs reserve nothing."""
    with reserved_domain() as domain:
        pass
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as port:
        port.bind(('127.0.0.1', 7400 + 250 * domain + 11))
        with reserved_domain() as free:
            assert free != domain
        with reserved_domain(domain) as requested:
            assert requested == domain


def test_a_reserved_domain_is_nobody_elses() -> None:
    with reserved_domain() as domain:
        with reserved_domain() as other:
            assert other != domain
        with pytest.raises(RigError, match=f'in domain {domain} already'), reserved_domain(domain):
            pass


def test_an_experiment_in_a_domain_that_is_taken_leaves_no_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / 'there').mkdir()
    with reserved_domain() as domain:
        monkeypatch.setenv('ROS_DOMAIN_ID', str(domain))
        for folder in ('new', 'there'):
            with pytest.raises(RigError, match='already'):
                run_experiment(Setup(bags=tmp_path / folder), lambda _: None)
    assert [path.name for path in tmp_path.iterdir()] == ['there']
    with pytest.raises(UsageError, match='null byte'):
        run_experiment(Setup(bags=tmp_path / 'a\0b'), lambda _: None)
