"""The policy is one that SROS2 reads, and allows what the nodes do and no more.

That it is enforced is not tested: the Fast DDS of the wheels is built without security.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest
import rclpy
from rclpy._rclpy_pybind11 import NodeNameNonExistentError  # it has no public type
from rclpy.context import Context
from rclpy.node import Node

from kapitsa_ros.network.registry import NODES, ROLE_NAMES
from kapitsa_ros.operator.protocol import MANUAL
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.rig.node_group import NodeGroup
from kapitsa_ros.rig.setup import Setup, parameters
from kapitsa_ros.rig.sros2_policy import answered, policy, published, subscribed

pytestmark = pytest.mark.xdist_group('processes')
ROLES = {'jigsaw', 'pendulum', 'strobe', 'stopwatch', 'operator', 'analyser', 'recorder', 'player'}
ACCESS = {'topics': {'publish', 'subscribe'}, 'services': {'reply', 'request'}, 'actions': {'call', 'execute'}}
"""What a profile may hold, after policy.xsd of sros2."""


def test_the_policy_has_the_form_that_sros2_reads(kapitsa) -> None:
    root = ET.fromstring(kapitsa('policy').out)
    assert (root.tag, root.attrib) == ('policy', {'version': '0.2.0'})
    [enclaves] = root
    assert enclaves.tag == 'enclaves'
    assert {enclave.get('path') for enclave in enclaves} == {f'/kapitsa_ros/{role}' for role in ROLES}
    for enclave in enclaves:
        [profiles] = enclave
        [profile] = profiles
        assert (enclave.tag, profiles.tag, profile.tag) == ('enclave', 'profiles', 'profile')
        assert profile.attrib == {'ns': '/', 'node': enclave.get('path').rpartition('/')[2]}
        for part in profile:
            [(access, permission)] = part.attrib.items()
            assert access in ACCESS[part.tag]
            assert permission == 'ALLOW'
            assert {item.tag for item in part} == {part.tag[:-1]}
            assert all(item.text.strip() for item in part)


def test_a_namespace_is_that_of_every_profile() -> None:
    assert {profile.get('ns') for profile in ET.fromstring(policy('/lab')).iter('profile')} == {'/lab'}


def test_nodes_do_what_the_policy_allows_and_nothing_else(
    domain: int, tmp_path: Path, eventually: Callable[[Callable[[], Any]], None]
) -> None:
    context = Context()
    with on_loopback():
        rclpy.init(context=context, domain_id=domain)
        observer = Node('observer', context=context)

    def names_of(role: str) -> tuple[set[str], ...]:
        """Return what a node has been heard to write, read and answer; its name may come later than the rest."""
        own = (role, '/')
        return tuple(
            {name for name, _ in found}
            for found in (
                observer.get_publisher_names_and_types_by_node(*own),
                observer.get_subscriber_names_and_types_by_node(*own),
                observer.get_service_names_and_types_by_node(*own),
            )
        )

    def absolute(role: str, names: tuple[str, ...]) -> set[str]:
        return {name.replace('~', f'/{role}') if name[0] in '~/' else f'/{name}' for name in names}

    def as_allowed(role) -> bool:
        try:
            writes, reads, serves = names_of(role.name)
        except NodeNameNonExistentError:
            return False
        return (
            writes == absolute(role.name, published(role))
            and reads | {'/clock'} == absolute(role.name, subscribed(role))  # that is of use_sim_time
            and serves == absolute(role.name, answered(role))
        )

    with NodeGroup(ROLE_NAMES, parameters(Setup(bags=tmp_path, rate=1.0, protocol=MANUAL)), domain):
        try:
            for role in NODES:
                if role.name in ROLE_NAMES:
                    eventually(lambda role=role: as_allowed(role))
        finally:
            observer.destroy_node()
            context.try_shutdown()
