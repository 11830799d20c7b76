"""The latched settings of the other nodes, for those who need them before the first step."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.registry import PLAYER, RIG_ROLES, described_by
from kapitsa_ros.network.settings import SETTINGS_TYPE, parse_settings, settings_topic
from kapitsa_ros.ros.errors import NodeError
from kapitsa_ros.ros.node_names import node_names, wait_for_names
from kapitsa_ros.ros.qos import EVERY_LATCHED, message_class

if TYPE_CHECKING:
    from collections.abc import Callable

    from kapitsa_ros.ros.dataflow_node import DataflowNode

LONGEST = 100_000
"""Characters of settings; those of a node have a thousand."""


class SettingsSubscriber:
    """Collects ROLE/settings of each role that describes a run: of all required ones, and of those expected.

    A role says its own once; a player those of each bag, once a run.

    Parameters
    ----------
    node
        Who needs them.
    roles
        Names of those whose settings are needed, if not of all.

    """

    def __init__(self, node: DataflowNode, roles: tuple[str, ...] | None = None) -> None:
        self.texts: dict[str, str] = {}
        """By role, as published."""
        self._open: set[str] = set()
        """Roles of which a player may say the settings of its next bag."""
        every = described_by(role for role in RIG_ROLES if not role.optional or role.name in node.expected)
        self._roles = every if roles is None else roles
        self._node = node
        for name in self._roles:
            kind = message_class(SETTINGS_TYPE)
            node.create_subscription(kind, settings_topic(name), self._taker(name), EVERY_LATCHED)

    @property
    def complete(self) -> bool:
        """Whether all have come."""
        return len(self.texts) == len(self._roles)

    def begin_run(self) -> None:
        """Hold to the settings that are there for the run that begins; a player may say those of its next bag, once."""
        if PLAYER.name in self._node.expected:
            self._open.update(self._roles)

    def parsed(self) -> dict[str, dict[str, Any]]:
        """Return the settings by role."""
        return {name: json.loads(self.texts[name]) for name in self._roles}

    def _taker(self, name: str) -> Callable[[Any], None]:
        def take(message: Any) -> None:
            why = _fault(message.data)
            if why is None and name not in self._open and self.texts.get(name, message.data) != message.data:
                why = self._fail_by_second_writer(name)
            if why is None:
                self._open.discard(name)  # also where they are the same: what differs after that is somebody else's
                self.texts[name] = message.data
            else:
                self._node.refuse(f'{settings_topic(name)}: {why}')

        return take

    def _fail_by_second_writer(self, name: str) -> str:
        """Fail by settings that differ from those that hold, and return why.

        They are not numbered, and which of two are the node's own cannot be told, even where one of them has left: so
        the run is over.
        """
        topic = settings_topic(name)
        names = wait_for_names(lambda: node_names(self._node.get_publishers_info_by_topic(topic)))
        own = next((each for each in names if each in {name, PLAYER.name}), None)
        if own is not None:  # another of this name is a second writer
            names.remove(own)
        others = ', '.join(names) or 'a node that has left'
        why = f'has a second writer, {others}: which settings are the right ones cannot be told'
        self._node.keep_failure(NodeError(f'{topic} {why}; choose another ROS_DOMAIN_ID, or stop it'))
        return why


def _fault(text: str) -> str | None:
    """Return why a text is no settings; None: it is."""
    if len(text) > LONGEST:
        return f'settings of {len(text)} characters'
    try:
        parse_settings(text)
    except WireError as error:
        return str(error)
    return None
