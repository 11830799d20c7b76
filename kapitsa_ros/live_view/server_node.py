"""A server of Foxglove's protocol for a rig or a replay that runs in this domain, at ws://127.0.0.1:8765.

Foxglove, and other clients of its protocol, see topics and model as they are, call the services of jigsaw or player,
set parameters, and ask the operator of a manual run for a speed or a release. With the bags of a replay they play,
pause and seek.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from foxglove.websocket import ServerListener
from rosgraph_msgs.msg import Clock

from kapitsa_ros.live_view.foxglove_server import ADDRESS, FoxgloveServer
from kapitsa_ros.live_view.frame_transforms import FrameTransforms
from kapitsa_ros.live_view.parameter_forwarder import ParameterForwarder
from kapitsa_ros.live_view.playback_control import PlaybackControl
from kapitsa_ros.live_view.replay_timeline import ReplayTimeline
from kapitsa_ros.live_view.request_forwarder import RequestForwarder
from kapitsa_ros.live_view.service_forwarder import ServiceForwarder
from kapitsa_ros.live_view.topic_forwarder import TopicForwarder
from kapitsa_ros.live_view.view_clock import ViewClock
from kapitsa_ros.network.role import Role
from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.reader import runs_of
from kapitsa_ros.ros.arguments import FOXGLOVE_PORT, FOXGLOVE_SERVER
from kapitsa_ros.ros.errors import SettingError
from kapitsa_ros.ros.executor_tasks import guarded
from kapitsa_ros.ros.parameters import declare
from kapitsa_ros.ros.process_node import ProcessNode
from kapitsa_ros.ros.qos import VIEW
from kapitsa_ros.ros.throttle import Throttle

if TYPE_CHECKING:
    from foxglove.websocket import (
        ChannelView,
        Client,
        ClientChannel,
        Parameter,
        PlaybackControlRequest,
        PlaybackState,
    )

_LOOK_PERIOD = 1.0
"""Seconds between two looks at the graph."""


class FoxgloveServerNode(ProcessNode, ServerListener):
    """Executable `foxglove_server`; the server calls it from threads of its own, ROS from that of the process."""

    def __init__(self) -> None:
        super().__init__(Role(name=FOXGLOVE_SERVER))
        self._port = declare(self, 'port', FOXGLOVE_PORT, f'of {ADDRESS}; 0: any that is free', 0, 65535)
        paths = [path for path in declare(self, 'bags', [''], 'folders of the runs that are replayed, if any') if path]
        timeline = self._timeline(paths) if paths else None
        self._range_ns = timeline.range_ns if timeline is not None else None
        self._server, self._view_clock = FoxgloveServer(), ViewClock(timeline)
        self._topic_forwarder = TopicForwarder(self, self._server, self._view_clock)
        self._frame_transforms = FrameTransforms(self, self._server, self._view_clock)
        self._service_forwarder = ServiceForwarder(self, self._server)
        self._request_forwarder = RequestForwarder(self, self._server)
        self._parameter_forwarder = ParameterForwarder(self, self._server)
        self._playback_control = (
            PlaybackControl(self, self._server, timeline, self._parameter_forwarder) if timeline is not None else None
        )
        self._looked = Throttle(_LOOK_PERIOD)
        self._is_changed = False
        """Whether a client wants other topics than before."""
        self.create_subscription(Clock, '/clock', self._take_clock, VIEW)

    def create_subscription(self, msg_type: Any, topic: str, callback: Any, *given: Any, **named: Any) -> Any:
        """Subscribe; what cannot be shown is refused: a view computes nothing that others rely on."""

        def refuse(error: Exception) -> None:
            self.refuse(f'{topic}: {error or type(error).__name__}')

        return super().create_subscription(msg_type, topic, guarded(callback, refuse), *given, **named)

    def open(self) -> None:
        """Begin to listen."""
        port = self._server.start(self._port, self, self._range_ns)
        self.get_logger().info(f'serves Foxglove at ws://{ADDRESS}:{port}')

    def poll(self) -> float:
        """Look at the graph now and then, and do what clients want."""
        if self._looked.due():
            self._topic_forwarder.look(self._frame_transforms.look())
            self._service_forwarder.look()
            self._parameter_forwarder.look()
            self._is_changed = True  # the server may tell of a client before it counts it
        if self._is_changed:
            self._is_changed = False
            self._topic_forwarder.tend()
            self._frame_transforms.tend()
        return min(_LOOK_PERIOD, self._request_forwarder.publish())

    def close(self) -> None:
        """Let the clients go."""
        self._server.stop()

    def _take_clock(self, message: Clock) -> None:
        is_first = self._view_clock.now_ns is None
        time_ns = self._view_clock.set(message.clock.sec * SECOND + message.clock.nanosec)
        if is_first:
            self._topic_forwarder.repeat()
        self._server.show_time(time_ns)
        if self._playback_control is not None:
            self._playback_control.show(time_ns)

    def _timeline(self, paths: list[str]) -> ReplayTimeline | None:
        try:
            return ReplayTimeline(runs_of(list(map(Path, paths))))
        except BagError as error:
            raise SettingError(f'parameter bags: {error}') from error
        except ValueError as error:
            self.get_logger().warning(f'no playback control: {error}')
            return None

    # What clients want, called in threads of the server.

    def on_subscribe(self, client: Client, channel: ChannelView) -> None:
        """Let the loop subscribe, too."""
        self._topic_forwarder.note(client.id, channel.topic)
        self._want()

    def on_unsubscribe(self, client: Client, channel: ChannelView) -> None:  # noqa: ARG002
        """Let the loop unsubscribe, where nobody else listens."""
        self._want()

    def on_client_advertise(self, client: Client, channel: ClientChannel) -> None:
        """Take note of a topic on which a client wants to ask for something."""
        self._request_forwarder.advertise(client, channel)

    def on_client_unadvertise(self, client: Client, client_channel_id: int) -> None:
        """Forget it."""
        self._request_forwarder.unadvertise(client, client_channel_id)

    def on_message_data(self, client: Client, client_channel_id: int, data: bytes) -> None:
        """Take a request in."""
        if self._request_forwarder.take(client, client_channel_id, data):
            self._wake()

    def on_get_parameters(
        self,
        client: Client,  # noqa: ARG002
        param_names: list[str],
        request_id: str | None = None,  # noqa: ARG002
    ) -> list[Parameter]:
        """Return parameters."""
        return self._parameter_forwarder.get(param_names)

    def on_set_parameters(
        self,
        client: Client,  # noqa: ARG002
        parameters: list[Parameter],
        request_id: str | None = None,  # noqa: ARG002
    ) -> list[Parameter]:
        """Set parameters, and return what they are."""
        return self._parameter_forwarder.set(parameters)

    def on_playback_control_request(self, playback_control_request: PlaybackControlRequest) -> PlaybackState | None:
        """Steer the replay."""
        return None if self._playback_control is None else self._playback_control.request(playback_control_request)

    def _want(self) -> None:
        self._is_changed = True
        self._wake()

    def _wake(self) -> None:
        if self.executor is not None:
            self.executor.wake()


create = FoxgloveServerNode
