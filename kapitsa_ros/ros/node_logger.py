"""The logger of a node."""

from __future__ import annotations

import inspect
from typing import Any

from rclpy import _rclpy_pybind11 as _rclpy
from rclpy.impl.rcutils_logger import RcutilsLogger


class NodeLogger(RcutilsLogger):
    """One that says its first line at once, and has no filters.

    That of rclpy looks for the source of its caller, in all modules of the process: a tenth of a second, in each node
    of a rig.
    """

    def log(self, message: str, severity: Any) -> bool:  # type: ignore[override]
        """Log a line."""
        frame = inspect.currentframe()
        assert frame is not None  # noqa: S101  # CPython has them
        assert frame.f_back is not None  # noqa: S101  # that of `info`, `warning` and so on
        caller = frame.f_back.f_back or frame.f_back
        code = caller.f_code
        _rclpy.rclpy_logging_rcutils_log(severity, self.name, message, code.co_name, code.co_filename, caller.f_lineno)
        return True
