"""Telling rclpy's own exceptions from all others."""

from __future__ import annotations

from rclpy._rclpy_pybind11 import InvalidHandle, RCLError  # they have no public type
from rclpy.exceptions import NotInitializedException
from rclpy.executors import ExternalShutdownException


def is_of_rclpy(error: Exception) -> bool:
    """Whether rclpy raised an exception, in Python or below; calls complain of a shut context each in its own way."""
    if isinstance(error, ExternalShutdownException | NotInitializedException | RCLError | InvalidHandle):
        return True
    frame = error.__traceback__
    while frame is not None and frame.tb_next is not None:
        frame = frame.tb_next
    return frame is not None and str(frame.tb_frame.f_globals.get('__name__')).startswith('rclpy')
