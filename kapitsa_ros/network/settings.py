"""The topic NODE/settings: JSON, latched; the parameters of a node, recorded with each run."""

from __future__ import annotations

from kapitsa_ros.network.typestore import deserialise, serialise

SETTINGS_TYPE = 'std_msgs/msg/String'


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
