"""Telling rclpy's own exceptions from all others."""

from __future__ import annotations

import os
import re

from rclpy._rclpy_pybind11 import InvalidHandle, RCLError  # they have no public type
from rclpy.exceptions import NotInitializedException
from rclpy.executors import ExternalShutdownException

from kapitsa_ros.errors import shorten
from kapitsa_ros.ros.reachability import PEERS

_PLACES = re.compile(r',? at /\S+\.\w+:\d+')


def no_node_text(error: Exception) -> str:
    """Return in one line why no node can be made; rcl gives ten, and of security no reason at all."""
    if text := security_text(error):
        return text
    why = first_line(error)
    if 'resolve peer' in why:
        peers = shorten(os.environ.get(PEERS, ''))
        return f'no node can be made, {PEERS} is {peers}: {why}: give addresses or names of hosts, ; in between'
    return f'no node can be made, ROS_DOMAIN_ID is {os.environ.get("ROS_DOMAIN_ID", "unset")}: {why}'


def security_text(error: Exception) -> str | None:
    """Return in one line what security needs, where it is asked for and rcl fails; None where it is not."""
    if os.environ.get('ROS_SECURITY_ENABLE', '').lower() != 'true':
        return None
    return (
        f'no node can be made with ROS_SECURITY_ENABLE=true ({first_line(error)}): security needs keys in '
        'ROS_SECURITY_KEYSTORE and a Fast DDS with its plugins, as a ROS installation has it; or unset it'
    )


def first_line(error: Exception) -> str:
    """Return the first line of what rcl says, without where that stands in its sources."""
    return _PLACES.sub('', str(error).splitlines()[0]) if str(error) else type(error).__name__


def is_of_rclpy(error: Exception) -> bool:
    """Whether rclpy raised an exception, in Python or below; calls complain of a shut context each in its own way."""
    if isinstance(error, ExternalShutdownException | NotInitializedException | RCLError | InvalidHandle):
        return True
    frame = error.__traceback__
    while frame is not None and frame.tb_next is not None:
        frame = frame.tb_next
    return frame is not None and str(frame.tb_frame.f_globals.get('__name__')).startswith('rclpy')
