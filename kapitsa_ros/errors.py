"""The base of every error that this package raises on purpose."""

from __future__ import annotations

from typing import Any, ClassVar

from kapitsa_ros.message import Message

WRONG_INPUT, FAILED = 2, 1
"""Exit statuses of a program: what it was given cannot be used; what it was to do failed."""
OPTION = '{option}'
"""Stands for the option in the message of an error that names one."""


_LONGEST_WORD, _LONGEST_PATH = 70, 200
"""Digests are as long as that word."""


def shorten(text: str, longest: int = 400) -> str:
    """Return a text on one line of so many characters at most, without its middle where it is longer.

    A word that is none, but what somebody gave for one, loses its own middle first: the rest says what to do about it.
    """
    if len(text) > 4 * longest:  # it may be a megabyte
        text = f'{text[: 2 * longest]}{text[-2 * longest :]}'
    words = (_without_middle(word, _LONGEST_PATH if '/' in word else _LONGEST_WORD, '…') for word in text.split())
    line = ' '.join(words)
    return _without_middle(line, longest, ' … ')


def _without_middle(text: str, longest: int, gap: str) -> str:
    if len(text) <= longest:
        return text
    end = longest // 3
    return f'{text[: longest - end - len(gap)]}{gap}{text[-end:]}'


class KapitsaError(Exception):
    """An error its user can correct; the message is one line that says how.

    Anything else that is raised is a defect of the package and is shown with its traceback.

    Parameters
    ----------
    message
        One line, or the template of one: see `Message`. Where it names an option of the command line, `OPTION` stands
        for it.
    option
        Name of that option, which launch files write in another way.
    value
        What was given for it, if the message is to repeat that.
    values
        What a template is filled with; it has no option.

    """

    exit_status: ClassVar[int] = WRONG_INPUT
    """With which a program ends that meets it."""

    def __init__(self, message: str = '', *, option: str | None = None, value: object = None, **values: Any) -> None:
        self.option = option
        self._message, self._value = message, '' if value is None else str(value)
        if option is not None:
            message = message.replace(OPTION, f'--{option} {self._value}'.strip(), 1)
        self.said = Message(message, **values)
        """The same, for those who say it in another language."""
        super().__init__(self.said)

    def in_launch(self) -> str:
        """Return the message with the option as launch files write it: NAME:=VALUE."""
        return str(self) if self.option is None else self._message.replace(OPTION, f'{self.option}:={self._value}', 1)


def said_of(error: Exception) -> Message:
    """Return what an error says, so that it can be said in another language where it is one of ours."""
    return error.said if isinstance(error, KapitsaError) else Message(str(error))


class QuantityError(KapitsaError, ValueError):
    """A value is no quantity of the required dimension; the message names it and shows one."""


class OutputError(KapitsaError):
    """A file cannot be written to the given path."""


class UnreadableSettingsError(KapitsaError):
    """A file of the user's settings for a package cannot be read."""


class MissingPackageError(KapitsaError):
    """A package is missing that comes with an extra; the message says how to install it."""

    exit_status = FAILED
