"""A replay in the hands of a client: play, pause, pace and place, carried out by the player."""

from __future__ import annotations

import math
from contextlib import suppress
from typing import TYPE_CHECKING

from diagnostic_msgs.msg import DiagnosticArray
from foxglove.websocket import PlaybackCommand, PlaybackState, PlaybackStatus
from rclpy.parameter import Parameter

from kapitsa_ros.live_view.answer import answer_to
from kapitsa_ros.network.registry import PLAYER
from kapitsa_ros.ros.time_control_client import TimeControlClient

if TYPE_CHECKING:
    from foxglove.websocket import PlaybackControlRequest
    from rclpy.node import Node

    from kapitsa_ros.live_view.foxglove_server import FoxgloveServer
    from kapitsa_ros.live_view.parameter_forwarder import ParameterForwarder
    from kapitsa_ros.live_view.replay_timeline import ReplayTimeline

_SLOWEST, _FASTEST = 0.001, 100.0


class PlaybackControl:
    """Steers the player, and tells clients how the replay stands, whoever steers it.

    Parameters
    ----------
    node
        Who calls the player of its namespace.
    server
        Whose clients are told.
    timeline
        Of the runs that are played.
    parameters
        Where the pace is known.

    """

    def __init__(
        self, node: Node, server: FoxgloveServer, timeline: ReplayTimeline, parameters: ParameterForwarder
    ) -> None:
        self._server, self._timeline, self._parameters = server, timeline, parameters
        self._player = TimeControlClient(node, PLAYER.name)
        owner = f'{node.get_namespace().rstrip("/")}/{PLAYER.name}'
        self._owner, self._report = owner, f'{PLAYER.name if owner.count("/") == 1 else owner}: progress'
        self._asked = 0.0
        """Pace that a client has asked for, where the player's is not known yet."""
        self._measured = 1.0
        """Simulated over wall seconds, where the player goes as fast as it can."""
        self._time_ns = timeline.range_ns[0]
        self._status = PlaybackStatus.Buffering
        node.create_subscription(DiagnosticArray, '/diagnostics', self._take_progress, 10)

    def request(self, request: PlaybackControlRequest) -> PlaybackState | None:
        """Do what a client wants, and return how the replay stands then."""
        try:
            did_seek = self._carry_out(request)
        except (TimeoutError, LookupError) as error:
            self._server.warn(str(error))
            did_seek = False
        if did_seek:  # the player says so too, once: that may be lost on its way
            self._server.show_time(self._time_ns)
        return self._state(did_seek=did_seek, request_id=request.request_id)

    def show(self, time_ns: int) -> None:
        """Take the time of the replay; where it has leapt back, clients have to forget what they have."""
        did_leap = time_ns < self._time_ns
        self._time_ns = time_ns
        if did_leap:
            self._server.show_playback(self._state(did_seek=True))

    def _carry_out(self, request: PlaybackControlRequest) -> bool:
        if not self._player.is_served():
            self._status = PlaybackStatus.Ended
            raise LookupError('the player has left: start the replay again, with loop:=true to keep it')
        wanted: dict[str, float] = {}
        if abs(request.playback_speed - self._speed()) > 1e-6 * self._speed():
            wanted['rate'] = min(max(request.playback_speed, _SLOWEST), _FASTEST)
        if request.seek_time is not None:
            wanted['seek'] = self._timeline.seconds_at(request.seek_time)
            self._time_ns = self._timeline.range_ns[0]  # what comes is no leap that others have made
        is_to_play = request.playback_command == PlaybackCommand.Play
        if not is_to_play:  # before it goes to a place, or it would go on from there
            answer_to(self._player.call('pause'), PLAYER.name)  # which it refuses where it stands still
        self._set(wanted)
        if is_to_play:
            answer_to(self._player.call('resume'), PLAYER.name)
        self._status = PlaybackStatus.Playing if is_to_play else PlaybackStatus.Paused
        if request.seek_time is not None:
            begin, end = self._timeline.range_ns
            self._time_ns = min(max(request.seek_time, begin), end)
        return request.seek_time is not None

    def _set(self, wanted: dict[str, float]) -> None:
        if not wanted:
            return
        results = answer_to(self._player.set_parameters(**wanted), PLAYER.name).results
        for (name, value), result in zip(wanted.items(), results, strict=True):
            if not result.successful:
                self._server.warn(result.reason)
            elif name == 'rate':
                self._asked = value
                self._parameters.take(self._owner, [Parameter(name, value=value)])

    def _speed(self) -> float:
        rate = self._parameters.value(f'{self._owner}.rate', self._asked)
        return rate if isinstance(rate, float) and 0 < rate < math.inf else self._measured  # anybody may say another

    def _state(self, *, did_seek: bool, request_id: str | None = None) -> PlaybackState:
        return PlaybackState(
            status=self._status,
            current_time=self._time_ns,
            playback_speed=self._speed(),
            did_seek=did_seek,
            request_id=request_id,
        )

    def _take_progress(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.name != self._report:
                continue
            values = {pair.key: pair.value for pair in status.values}
            with suppress(KeyError, ValueError):  # anybody may speak there
                measured = float(values['realtime_factor'])
                self._measured = measured if 0 < measured < math.inf else self._measured
            if values.get('session_over') == 'True':
                self._status = PlaybackStatus.Ended
            else:
                self._status = PlaybackStatus.Paused if values.get('paused') == 'True' else PlaybackStatus.Playing
            self._server.show_playback(self._state(did_seek=False))  # each time: a client may have come
