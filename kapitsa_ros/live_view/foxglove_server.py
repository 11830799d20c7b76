"""The server of Foxglove's protocol itself: this machine's clients, what they are told, and what they ask for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import foxglove
from foxglove.websocket import Capability, StatusLevel, WebSocketServer

from kapitsa_ros.ros.errors import SettingError

if TYPE_CHECKING:
    from foxglove.websocket import Parameter, PlaybackState, ServerListener, Service

ADDRESS = '127.0.0.1'
"""Nothing else is listened on: the protocol has no token, and who is connected may reset a run."""
ENCODING = 'cdr'
SCHEMA_ENCODING = 'ros2msg'
_NAME = 'kapitsa_ros'
_CAPABILITIES = [Capability.ClientPublish, Capability.Parameters, Capability.Services, Capability.Time]


class FoxgloveServer:
    """Serves clients from `start` to `stop`; one that does not read loses the oldest messages, and holds up nobody."""

    def __init__(self) -> None:
        self.context = foxglove.Context()
        """Of the channels that clients see."""
        self._server: WebSocketServer | None = None

    def start(self, port: int, listener: ServerListener, time_range: tuple[int, int] | None) -> int:
        """Begin to listen on a port of the loopback interface, 0: any that is free; return which.

        Parameters
        ----------
        port
            From 0 to 65535.
        listener
            Told what clients ask for, in threads of the server.
        time_range
            Beginning and end of what is played, ns; None: it is no replay, and has no playback control.

        Raises
        ------
        SettingError
            The port is taken.

        """
        try:
            self._server = foxglove.start_server(
                name=_NAME,
                host=ADDRESS,
                port=port,
                capabilities=_CAPABILITIES,
                supported_encodings=[ENCODING],
                server_listener=listener,
                context=self.context,
                playback_time_range=time_range,
            )
        except RuntimeError as error:
            raise SettingError(f'parameter port: {ADDRESS}:{port} cannot be listened on: give another') from error
        return self._server.port

    def stop(self) -> None:
        """Say goodbye to all clients."""
        if self._server is not None:
            self._server.stop()
            self._server = None

    def channel(self, topic: str, message_type: str, definition: str) -> foxglove.Channel:
        """Return a new channel, which clients see from now on."""
        schema = foxglove.Schema(name=message_type, encoding=SCHEMA_ENCODING, data=definition.encode())
        return foxglove.Channel(topic, schema=schema, message_encoding=ENCODING, context=self.context)

    def warn(self, text: str) -> None:
        """Show all clients a line."""
        if self._server is not None:
            self._server.publish_status(text, StatusLevel.Warning)

    def show_time(self, time_ns: int) -> None:
        """Tell all clients the time."""
        if self._server is not None:
            self._server.broadcast_time(time_ns)

    def show_playback(self, state: PlaybackState) -> None:
        """Tell all clients how a replay stands."""
        if self._server is not None:
            self._server.broadcast_playback_state(state)

    def show_parameters(self, parameters: list[Parameter]) -> None:
        """Tell those that have subscribed to parameters what these are now."""
        if self._server is not None:
            self._server.publish_parameter_values(parameters)

    def offer(self, services: list[Service]) -> None:
        """Offer services from now on."""
        if self._server is not None:
            self._server.add_services(services)

    def withdraw(self, names: list[str]) -> None:
        """Offer services no more."""
        if self._server is not None:
            self._server.remove_services(names)
