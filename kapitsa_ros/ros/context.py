"""The one context of rclpy that a program has: its nodes begin and end it, or somebody else does."""

from __future__ import annotations

import rclpy

from kapitsa_ros.ros.errors import SettingError


def refuse_second_context() -> None:
    """Look whether ROS is at work in this program.

    Raises
    ------
    SettingError
        It is: a process of nodes begins and ends it itself.

    """
    if rclpy.ok():
        raise SettingError('ROS is initialised in this program: call rclpy.shutdown() before, or use kapitsa_ros.Rig')
