"""Values as they are written on a command line or in a launch argument: NAME=VALUE."""

from __future__ import annotations

from typing import TYPE_CHECKING

from kapitsa_ros.configuration.errors import ConfigurationError

if TYPE_CHECKING:
    from collections.abc import Iterable


def parse_assignments(texts: Iterable[str]) -> dict[str, str]:
    """Return the values by name; of several for one name the last.

    Raises
    ------
    ConfigurationError
        A text is no assignment.

    """
    values = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition('='))
        if not (name and equals and value):
            raise ConfigurationError(f'{text!r} is no assignment: write NAME=VALUE, as in reaction_time=0.2')
        values[name] = value
    return values
