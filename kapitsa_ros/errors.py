"""The base of every error that this package raises on purpose."""

from __future__ import annotations

from typing import ClassVar

WRONG_INPUT, FAILED = 2, 1
"""Exit statuses of a program: what it was given cannot be used; what it was to do failed."""


class KapitsaError(Exception):
    """Something its user can mend; the message is one line that says how.

    Anything else that is raised is a defect of the package and is shown with its traceback.
    """

    exit_status: ClassVar[int] = WRONG_INPUT
    """With which a program ends that meets it."""


class QuantityError(KapitsaError, ValueError):
    """A value is no quantity of the dimension that is asked for; the message names it and shows one."""


class MissingPackageError(KapitsaError):
    """A package is missing that comes with an extra; the message says how to install it."""

    exit_status = FAILED
