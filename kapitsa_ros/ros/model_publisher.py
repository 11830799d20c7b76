"""The topic `robot_description`: the model of the plant, for viewers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from std_msgs.msg import String

from kapitsa_ros.configuration.urdf import urdf
from kapitsa_ros.ros.qos import LATCHED

if TYPE_CHECKING:
    from rclpy.node import Node

    from kapitsa_ros.physics.plant import Plant


class ModelPublisher:
    """Latches the model of a plant, for viewers that come now or later."""

    def __init__(self, node: Node) -> None:
        self._publisher = node.create_publisher(String, 'robot_description', LATCHED)

    def publish(self, plant: Plant) -> None:
        """Show this plant from now on."""
        self._publisher.publish(String(data=urdf(plant)))
