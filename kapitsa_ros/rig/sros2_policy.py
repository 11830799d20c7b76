"""What each role may publish, hear and answer, as a policy of SROS2: an enclave a role."""

from __future__ import annotations

from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

from kapitsa_ros.network.registry import (
    ANALYSER,
    JIGSAW,
    NODES,
    OPERATOR,
    PENDULUM,
    PLAYER,
    RECORDER,
    REQUESTS,
    described_by,
)
from kapitsa_ros.network.settings import settings_topic
from kapitsa_ros.ros.time_control_client import SERVICES

if TYPE_CHECKING:
    from collections.abc import Iterable

    from kapitsa_ros.network.role import Role

VERSION = '0.2.0'
"""Of the policy format."""
ENCLAVES = '/kapitsa_ros'
_SETTINGS = tuple(settings_topic(name) for name in described_by())
_VIEWED = ('joint_states', 'robot_description')
_PUBLISHED = {JIGSAW: ('/clock',), PENDULUM: _VIEWED, PLAYER: ('/clock', *_VIEWED, *_SETTINGS)}
_SUBSCRIBED = {
    PENDULUM: (settings_topic(JIGSAW.name),),
    OPERATOR: REQUESTS,
    ANALYSER: _SETTINGS,
    RECORDER: _SETTINGS,
}
_TIME = tuple(f'~/{name}' for name in SERVICES)
_ANSWERED = {JIGSAW: (*_TIME, '~/reset'), PLAYER: _TIME}
_OF_ALL_PUBLISHED = ('/diagnostics', '/rosout', '/parameter_events')
_OF_ALL_SUBSCRIBED = ('/clock',)  # where use_sim_time is set
_OF_ALL_ANSWERED = tuple(
    f'~/{name}'
    for name in (
        'describe_parameters', 'get_parameter_types', 'get_parameters', 'get_type_description', 'list_parameters',
        'set_parameters', 'set_parameters_atomically',
    )
)  # fmt: skip


def published(role: Role) -> tuple[str, ...]:
    """Return the names of the topics that a role writes, relative to its namespace."""
    own = (settings_topic(role.name),) if role.describes_run else ()
    return (*(topic.name for topic in role.writes), *own, *_PUBLISHED.get(role, ()), *_OF_ALL_PUBLISHED)


def subscribed(role: Role) -> tuple[str, ...]:
    """Return the names of the topics that a role reads."""
    return (*(topic.name for topic in role.reads), *_SUBSCRIBED.get(role, ()), *_OF_ALL_SUBSCRIBED)


def answered(role: Role) -> tuple[str, ...]:
    """Return the names of the services that a role has."""
    return (*_ANSWERED.get(role, ()), *_OF_ALL_ANSWERED)


def policy(namespace: str = '/') -> str:
    """Return the policy of all roles in a namespace, as `ros2 security create_permission` reads it."""
    root = ET.Element('policy', version=VERSION)
    enclaves = ET.SubElement(root, 'enclaves')
    for role in NODES:
        enclave = ET.SubElement(enclaves, 'enclave', path=f'{ENCLAVES}/{role.name}')
        profile = ET.SubElement(ET.SubElement(enclave, 'profiles'), 'profile', ns=namespace, node=role.name)
        for kind, access, names in (
            ('topic', 'publish', published(role)),
            ('topic', 'subscribe', subscribed(role)),
            ('service', 'reply', answered(role)),
        ):
            _allow(profile, kind, access, names)
    ET.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n'


def _allow(profile: ET.Element, kind: str, access: str, names: Iterable[str]) -> None:
    allowed = ET.SubElement(profile, f'{kind}s', {access: 'ALLOW'})
    for name in names:
        ET.SubElement(allowed, kind).text = name
