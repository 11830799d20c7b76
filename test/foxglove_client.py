"""A client of Foxglove's protocol, by its specification: JSON one way and the other, and binary frames of messages."""

import json
import re
import struct
import time
from collections import defaultdict
from collections.abc import Callable
from contextlib import ExitStack, suppress
from typing import Any, Self

from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from websockets.sync.client import connect

PATIENCE = 180.0
_MESSAGE, _TIME, _ANSWER, _PLAYBACK = 1, 2, 3, 5
"""First bytes of binary frames from the server."""
_PUBLISH, _CALL, _CONTROL = 1, 2, 3
"""And to it."""
PLAY, PAUSE = 0, 1
STATUS = ('playing', 'paused', 'buffering', 'ended')


class FoxgloveClient:
    """Keeps what the server says; a context."""

    def __init__(self, port: int) -> None:
        self.port = port
        self._stack = ExitStack()
        address = f'ws://127.0.0.1:{port}'
        self.link: Any = self._stack.enter_context(connect(address, subprotocols=['foxglove.sdk.v1'], max_size=None))
        self.info: dict[str, Any] = {}
        self.channels: dict[str, dict[str, Any]] = {}
        self.services: dict[str, dict[str, Any]] = {}
        self.parameters: dict[str, Any] = {}
        self.warnings: list[str] = []
        self.messages: dict[str, list[tuple[int, bytes]]] = defaultdict(list)
        """By topic: time, ns, and bytes."""
        self.times: list[int] = []
        self.answers: dict[int, bytes | str] = {}
        """By call; a text where it failed."""
        self.playback: list[dict[str, Any]] = []
        self._number = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def until(self, true: Callable[[], Any], patience: float = PATIENCE) -> None:
        deadline = time.monotonic() + patience
        while not true():
            try:
                self._take(self.link.recv(timeout=deadline - time.monotonic()))
            except TimeoutError as error:
                came = {topic: len(messages) for topic, messages in self.messages.items()}
                raise TimeoutError(f'it has not come to pass; messages {came}, times {self.times[-1:]}') from error

    def settle(self, seconds: float) -> None:
        with suppress(TimeoutError):
            self.until(lambda: False, seconds)

    def subscribe(self, *topics: str) -> None:
        self.until(lambda: self.channels.keys() >= set(topics))
        self._subscribe(*(self.channels[topic]['id'] for topic in topics))

    def _subscribe(self, *channels: int) -> None:
        self.send(op='subscribe', subscriptions=[{'id': number, 'channelId': number} for number in channels])

    def decoded(self, topic: str) -> list[tuple[int, Any]]:
        """Return the messages of a topic as the schema that the server gives says they are."""
        channel = self.channels[topic]
        assert (channel['encoding'], channel['schemaEncoding']) == ('cdr', 'ros2msg')
        store = get_typestore(Stores.EMPTY)
        store.register(get_types_from_msg(channel['schema'], channel['schemaName']))
        return [(at, store.deserialize_cdr(raw, channel['schemaName'])) for at, raw in self.messages[topic]]

    def call(self, service: str) -> tuple[bool, str]:
        """Call a std_srvs/Trigger; return success and message."""
        self.until(lambda: service in self.services)
        self._number += 1
        number, encoding = self._number, b'cdr'
        head = struct.pack('<BIII', _CALL, self.services[service]['id'], number, len(encoding))
        self.link.send(head + encoding + b'\x00\x01\x00\x00')
        self.until(lambda: number in self.answers)
        answer = self.answers.pop(number)
        if isinstance(answer, str):
            return False, answer
        (length,) = struct.unpack_from('<I', answer, 8)
        return bool(answer[4]), answer[12 : 12 + length - 1].decode()

    def get(self, *names: str) -> dict[str, Any]:
        self._number += 1
        self.parameters.clear()
        self.send(op='getParameters', parameterNames=names, id=str(self._number))
        self.until(lambda: self.parameters.keys() >= set(names))
        return dict(self.parameters)

    def watch(self, *names: str) -> None:
        self.send(op='subscribeParameterUpdates', parameterNames=names)

    def set(self, name: str, value: Any) -> None:
        self.send(op='setParameters', parameters=[{'name': name, 'value': value}])

    def publish(self, topic: str, value: float, kind: str = 'std_msgs/msg/Float64') -> None:
        self._number += 1
        self.send(
            op='advertise', channels=[{'id': self._number, 'topic': topic, 'encoding': 'cdr', 'schemaName': kind}]
        )
        self.link.send(struct.pack('<BI', _PUBLISH, self._number) + b'\x00\x01\x00\x00' + struct.pack('<d', value))

    def control(self, command: int, speed: float = 1.0, seek_ns: int | None = None) -> dict[str, Any]:
        """Play or pause; return the state of the replay that the server answers."""
        self._number += 1
        name = f'c{self._number}'.encode()
        head = struct.pack('<BBfB', _CONTROL, command, speed, seek_ns is not None)
        self.link.send(head + struct.pack('<QI', seek_ns or 0, len(name)) + name)
        self.until(lambda: any(state['request'] == name.decode() for state in self.playback))
        return self.playback[-1]

    def send(self, **message: Any) -> None:
        self.link.send(json.dumps(message))

    def _take(self, frame: str | bytes) -> None:
        if isinstance(frame, bytes):
            self._take_binary(frame)
            return
        said = json.loads(frame)
        match said['op']:
            case 'serverInfo':
                self.info = said
            case 'advertise':
                self.channels |= {channel['topic']: channel for channel in said['channels']}
            case 'advertiseServices':
                self.services |= {service['name']: service for service in said['services']}
            case 'parameterValues':
                self.parameters |= {item['name']: item.get('value') for item in said['parameters']}
            case 'status' if unknown := re.search(r'unknown channel\D*(\d+)', said['message'], re.IGNORECASE):
                self._subscribe(int(unknown[1]))  # the SDK tells of a channel a moment before it takes subscriptions
            case 'status':
                self.warnings.append(said['message'])
            case 'serviceCallFailure':
                self.answers[said['callId']] = said['message']

    def _take_binary(self, frame: bytes) -> None:
        if frame[0] == _MESSAGE:
            channel, at = struct.unpack_from('<IQ', frame, 1)
            topic = next(name for name, known in self.channels.items() if known['id'] == channel)
            self.messages[topic].append((at, frame[13:]))
        elif frame[0] == _TIME:
            self.times.append(*struct.unpack_from('<Q', frame, 1))
        elif frame[0] == _ANSWER:
            _, call, length = struct.unpack_from('<III', frame, 1)
            self.answers[call] = frame[13 + length :]
        elif frame[0] == _PLAYBACK:
            status, at, speed, did_seek, _ = struct.unpack_from('<BQfBI', frame, 1)
            state = {'status': STATUS[status], 'time': at, 'speed': speed, 'sought': bool(did_seek)}
            self.playback.append(state | {'request': frame[19:].decode()})
