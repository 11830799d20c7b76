"""The latched settings of the other nodes, for those who need them before the first step."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from kapitsa_ros.network.registry import RIG_ROLES, described_by
from kapitsa_ros.network.settings import SETTINGS_TYPE, settings_topic
from kapitsa_ros.ros.qos import LATCHED, message_class

if TYPE_CHECKING:
    from collections.abc import Callable

    from kapitsa_ros.ros.dataflow_node import DataflowNode


class SettingsSubscriber:
    """Collects ROLE/settings of each role that describes a run: of all required ones, and of those expected."""

    def __init__(self, node: DataflowNode) -> None:
        self.texts: dict[str, str] = {}
        """By role, as published."""
        self._roles = described_by(role for role in RIG_ROLES if not role.optional or role.name in node.expected)
        for name in self._roles:
            node.create_subscription(message_class(SETTINGS_TYPE), settings_topic(name), self._taker(name), LATCHED)

    @property
    def complete(self) -> bool:
        """Whether all have come."""
        return len(self.texts) == len(self._roles)

    def parsed(self) -> dict[str, dict[str, Any]]:
        """Return the settings by role."""
        return {name: json.loads(self.texts[name]) for name in self._roles}

    def _taker(self, name: str) -> Callable[[Any], None]:
        def take(message: Any) -> None:
            self.texts[name] = message.data

        return take
