"""The topic NODE/settings: JSON, latched; the parameters of a node, recorded with each run."""

from __future__ import annotations

import json
from typing import Any

from kapitsa_ros.errors import shorten
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.typestore import deserialise, serialise

SETTINGS_TYPE = 'std_msgs/msg/String'
_OBJECTS = ('instrument', 'plant', 'versions')
"""Settings that consist of settings."""


def settings_topic(role: str) -> str:
    """Return the topic on which a node latches its settings."""
    return f'{role}/settings'


def encode_settings(text: str) -> bytes:
    """Encode a JSON text."""
    return serialise(SETTINGS_TYPE, text)


def decode_settings(raw: bytes) -> str:
    """Decode a JSON text.

    Raises
    ------
    WireError
        The bytes are no std_msgs/String.

    """
    return str(deserialise(SETTINGS_TYPE, raw).data)


def parse_settings(text: str) -> dict[str, Any]:
    """Return the settings in a JSON text; what they are worth says who uses them.

    Raises
    ------
    WireError
        It is no JSON object, or what the analysis takes for an object or for a seed is none.

    """
    try:
        settings = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise WireError(f'no JSON ({error})') from error
    if not isinstance(settings, dict):
        raise WireError(f'no JSON object: {text}')
    for name in _OBJECTS:
        if not isinstance(settings.get(name, {}), dict):
            raise WireError(f'{name} is no JSON object: {shorten(json.dumps(settings[name]))}')
    seed = settings.get('seed')
    if seed is not None and (type(seed) is not int or seed < 0):
        raise WireError(f'seed is no whole number from 0 on: {shorten(json.dumps(seed))}')
    return settings
