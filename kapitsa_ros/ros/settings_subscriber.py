"""The latched settings of the other nodes, for those who need them before the first step."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from kapitsa_ros.network.run import SETTINGS_OF
from kapitsa_ros.network.topics import SETTINGS_TYPE, settings_topic
from kapitsa_ros.ros.qos import LATCHED, message_class

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node


class SettingsSubscriber:
    """Collects NODE/settings of each node that describes a part of the rig."""

    def __init__(self, node: Node) -> None:
        self.texts: dict[str, str] = {}
        """By node, as published."""
        for name in SETTINGS_OF:
            node.create_subscription(message_class(SETTINGS_TYPE), settings_topic(name), self._taker(name), LATCHED)

    @property
    def complete(self) -> bool:
        """Whether all have come."""
        return len(self.texts) == len(SETTINGS_OF)

    def parsed(self) -> dict[str, dict[str, Any]]:
        """Return the settings by node."""
        return {name: json.loads(self.texts[name]) for name in SETTINGS_OF}

    def _taker(self, name: str) -> Callable[[Any], None]:
        def take(message: Any) -> None:
            self.texts[name] = message.data

        return take
