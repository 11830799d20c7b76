"""Results of the analyser."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from kapitsa_ros.network.codec import Codec
from kapitsa_ros.network.errors import WireError
from kapitsa_ros.network.typestore import deserialise, new_header, new_message, serialise

if TYPE_CHECKING:
    from kapitsa_ros.network.step_id import StepId

Results = Mapping[str, Mapping[str, Any]]
"""Values by the name of what they describe, such as `run 1` or `experiment`."""


class ResultCodec(Codec[Results]):
    """diagnostic_msgs/DiagnosticArray: one status a name, its values as JSON."""

    message_type = 'diagnostic_msgs/msg/DiagnosticArray'
    empty_body = bytes(4)

    def encode(self, stamp_ns: int, step_id: StepId, value: Results) -> bytes:
        """Encode results."""
        return serialise(
            self.message_type,
            new_header(stamp_ns, step_id),
            [
                new_message(
                    'diagnostic_msgs/msg/DiagnosticStatus',
                    level=0,
                    name=name,
                    message='',
                    hardware_id='',
                    values=[
                        new_message('diagnostic_msgs/msg/KeyValue', key, json.dumps(item))
                        for key, item in pairs.items()
                    ],
                )
                for name, pairs in value.items()
            ],
        )

    def decode(self, raw: bytes) -> Results:
        """Decode results."""
        message = deserialise(self.message_type, raw)
        try:
            return {
                status.name: {pair.key: json.loads(pair.value) for pair in status.values} for status in message.status
            }
        except (ValueError, RecursionError) as error:  # digits or brackets without end, too
            raise WireError(f'a result is not JSON: {error}') from error
