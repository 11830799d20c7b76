"""The base of every error that this package raises on purpose."""

from __future__ import annotations

from typing import ClassVar

WRONG_INPUT, FAILED = 2, 1
"""Exit statuses of a program: what it was given cannot be used; what it was to do failed."""
OPTION = '{option}'
"""Stands for the option in the message of an error that names one."""


def shorten(text: str, longest: int = 400) -> str:
    """Return a text on one line of so many characters at most, without its middle where it is longer."""
    if len(text) > 4 * longest:  # it may be a megabyte
        text = f'{text[: 2 * longest]} {text[-2 * longest :]}'
    line = ' '.join(text.split())
    if len(line) <= longest:
        return line
    end = longest // 3
    return f'{line[: longest - end - 3]} … {line[-end:]}'


class KapitsaError(Exception):
    """An error its user can correct; the message is one line that says how.

    Anything else that is raised is a defect of the package and is shown with its traceback.

    Parameters
    ----------
    message
        One line. Where it names an option of the command line, `OPTION` stands for it.
    option
        Name of that option, which launch files write in another way.
    value
        What was given for it, if the message is to repeat that.

    """

    exit_status: ClassVar[int] = WRONG_INPUT
    """With which a program ends that meets it."""

    def __init__(self, message: str = '', *, option: str | None = None, value: object = None) -> None:
        self.option = option
        self._message, self._value = message, '' if value is None else str(value)
        super().__init__(message if option is None else message.replace(OPTION, f'--{option} {self._value}'.strip(), 1))

    def in_launch(self) -> str:
        """Return the message with the option as launch files write it: NAME:=VALUE."""
        return str(self) if self.option is None else self._message.replace(OPTION, f'{self.option}:={self._value}', 1)


class QuantityError(KapitsaError, ValueError):
    """A value is no quantity of the required dimension; the message names it and shows one."""


class OutputError(KapitsaError):
    """A file cannot be written to the given path."""


class MissingPackageError(KapitsaError):
    """A package is missing that comes with an extra; the message says how to install it."""

    exit_status = FAILED
