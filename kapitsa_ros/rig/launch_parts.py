"""What the launch files have in common; imported by them alone, where launch is installed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from launch.actions import DeclareLaunchArgument, OpaqueFunction, SetEnvironmentVariable
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

from kapitsa_ros.rig.environment import loopback
from kapitsa_ros.rig.launched import end_with_failed
from launch import LaunchContext, LaunchDescription, LaunchDescriptionEntity

Arguments = Mapping[str, tuple[str, str, list[str] | None]]
"""Default, meaning and choices by name."""
Start = Callable[[dict[str, str]], list[LaunchDescriptionEntity]]
"""Returns what is started, from the values of the arguments."""


def describe(arguments: Arguments, start: Start) -> LaunchDescription:
    """Return a launch that declares arguments, keeps to this machine, and starts what their values say."""
    declared = [
        DeclareLaunchArgument(name, default_value=default, description=text, choices=choices)
        for name, (default, text, choices) in arguments.items()
    ]
    here = [SetEnvironmentVariable(name, value) for name, value in loopback().items()]

    def act(context: LaunchContext) -> list[LaunchDescriptionEntity]:
        return start({name: LaunchConfiguration(name).perform(context) for name in arguments})

    return LaunchDescription([*declared, *here, OpaqueFunction(function=act)])


def role_node(role: str, told: Mapping[str, Any]) -> Node:
    """Return the action that starts a role, and that ends the launch when its node fails."""
    return Node(
        package='kapitsa_ros', executable=role, name=role, parameters=[told], output='screen', on_exit=end_with_failed
    )
