"""What becomes of a rig under thirty kinds of hostile messages on each topic that nodes read of one another.

Prints, for each topic and rate, how many kinds were ignored (the bags are those of an undisturbed rig, byte for byte,
and the result printed is theirs) and how many ended the experiment with one line; then the lines. Status 1 if a result
was changed, a traceback shown, or a rig ended without a word. With --catch-up each message carries the publication
number that the topic's own writer has next, as only a node that counts along can do; otherwise the stranger's
publications are numbered as they come.
"""

from __future__ import annotations

import argparse
import json
import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import yaml
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import String

from kapitsa_ros.laboratory.bag_analysis import analyse_bags
from kapitsa_ros.network.cdr import read_step_id
from kapitsa_ros.network.registry import COMMAND, PIVOT, TOPICS
from kapitsa_ros.network.step_id import StepId
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.ros.qos import LATCHED, STREAM, message_class

if TYPE_CHECKING:
    from collections.abc import Callable

    Kind = Callable[[Any, StepId], Any]

CLASSES = {topic.name: message_class(topic.type) for topic in TOPICS} | {
    'diagnostics': DiagnosticArray,
    'jigsaw/settings': String,
}
VOLLEY = 3


def header_of(message: Any) -> Any:
    """Return the header of a message, which may be nothing else."""
    return getattr(message, 'header', message)


def numbered(number: Callable[[StepId], StepId]) -> Kind:
    """Return a kind of message that is well formed, and has a number made of that of the next step."""

    def make(message: Any, step: StepId) -> Any:
        found = number(step)
        if hasattr(message, 'data'):
            message.data = json.dumps(json.loads(message.data) | {'seed': found.run, 'step': found.step})
        elif hasattr(message, 'status') and not message.header.frame_id:
            for status in message.status:
                for pair in status.values:
                    pair.value = {'run': str(found.run), 'step': str(found.step)}.get(pair.key, str(found.end))
        else:
            header_of(message).frame_id = str(found)
        return message

    return make


def changed(change: Callable[[Any], Any]) -> Kind:
    """Return a kind of message with the right number, in which `change` was made of each value but that."""

    def walk(value: Any) -> Any:
        if hasattr(value, 'get_fields_and_field_types'):
            for name in value.get_fields_and_field_types():
                if name not in {'header', 'stamp', 'frame_id'}:
                    setattr(value, name, walk(getattr(value, name)))
            return value
        if isinstance(value, str | float | int | bytes):
            return change(value)
        found = [walk(each) for each in value]
        kept = change(found)
        return kept if isinstance(kept, list) else found

    return lambda message, step: walk(numbered(lambda next_step: next_step)(message, step))


def floats(number: float) -> Kind:
    """Return a kind of message in which each number with a point is this one."""
    return changed(lambda value: number if isinstance(value, float) else value)


def texts(text: str) -> Kind:
    """Return a kind of message in which each text is this one."""
    return changed(lambda value: text if isinstance(value, str) else value)


def lists(cut: Callable[[list[Any]], list[Any]]) -> Kind:
    """Return a kind of message in which each list is cut like this."""
    return changed(lambda value: cut(value) if isinstance(value, list) else value)


def raw(spoil: Callable[[bytes], bytes]) -> Kind:
    """Return a kind of message whose bytes are spoilt."""
    return lambda message, step: spoil(serialize_message(numbered(lambda next_step: next_step)(message, step)))


def framed(text: str) -> Kind:
    """Return a kind of message whose number is another text; where it has none, that is what it says."""

    def make(message: Any, step: StepId) -> Any:
        if not hasattr(message, 'data') and header_of(message).frame_id:
            header_of(message).frame_id = text
            return message
        return texts(text)(message, step)

    return make


def stamped(message: Any, step: StepId) -> Any:
    """Return a message of another day."""
    if not hasattr(message, 'data'):
        header_of(message).stamp.sec = -1
    return numbered(lambda next_step: next_step)(message, step)


KINDS: dict[str, Kind] = {
    'the next step': numbered(lambda step: step),
    'the step that was': numbered(lambda step: StepId(step.run, max(0, step.step - 1))),
    'eight steps ago': numbered(lambda step: StepId(step.run, max(0, step.step - 8))),
    'one step left out': numbered(lambda step: StepId(step.run, step.step + 1)),
    '500 steps ahead': numbered(lambda step: StepId(step.run, step.step + 500)),
    'step 9999999999': numbered(lambda step: StepId(step.run, 9_999_999_999)),
    'step -1': numbered(lambda step: StepId(step.run, -1)),
    'the run before': numbered(lambda step: StepId(step.run - 1, step.step)),
    'the next run': numbered(lambda step: StepId(step.run + 1, 0)),
    'the end of the run': numbered(lambda step: StepId(step.run, step.step, end=True)),
    'the end of the session': numbered(lambda step: StepId(step.run + 1, 0, end=True)),
    'the run begins again': numbered(lambda step: StepId(step.run, 0)),
    'no number': framed(''),
    'the name of a frame': framed('base_link'),
    'a number of a megabyte': framed('run 1 step ' + '9' * 1_000_000),
    'a number in another script': framed('run ١ step ٢'),
    'a stamp of another day': stamped,
    'not a number': floats(float('nan')),
    'infinite': floats(float('inf')),
    '1e308': floats(1e308),
    'one value missing': lists(lambda values: values[:-1]),
    'twice as many values': lists(lambda values: values * 2),
    'no values': lists(lambda _: []),
    'texts of a megabyte': texts('x' * 1_000_000),
    'no texts': texts(''),
    'no bytes': raw(lambda data: data[:4]),
    'half of the bytes': raw(lambda data: data[: len(data) // 8 * 4]),
    'lengths beyond the end': raw(lambda data: data[:16] + b'\xff\xff\xff\x7f' + data[20:]),
    'other bytes': raw(lambda data: data[:4] + random.Random(1).randbytes(len(data))),  # noqa: S311
    'the other byte order': raw(lambda data: b'\x00\x00\x00\x00' + data[4:]),
}


class Stranger:
    """Listens to a topic of a rig, and writes there what is not its to write."""

    def __init__(self, domain: int, topic: str) -> None:
        self._context = Context()
        with on_loopback():
            self._context.init(args=['--ros-args', '--disable-external-lib-logs'], domain_id=domain)
            self._node = Node('stranger', context=self._context, enable_rosout=False)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self._node)
        self._topic, self._kind = topic, CLASSES[topic]
        profile = LATCHED if topic.endswith('settings') else 10 if topic == 'diagnostics' else STREAM
        self.next = StepId(1, 0)
        self.own = self.said = 0
        """Publications of the topic's writer, and of this one."""
        self._newest = b''
        counted = PIVOT if topic == COMMAND.name else COMMAND
        self._node.create_subscription(message_class(counted.type), counted.name, self._count, STREAM, raw=True)
        self._node.create_subscription(self._kind, topic, self._keep, profile, raw=True)
        self._profile, self._out = profile, None

    @property
    def is_ready(self) -> bool:
        """Whether the rig is at work, and has said something on the topic that can be spoilt."""
        return bool(self._newest) and self.next.step > 8

    def join(self) -> None:
        """Begin to write; a rig refuses to start where somebody else does."""
        self._out = self._node.create_publisher(self._kind, self._topic, self._profile)

    @property
    def is_heard(self) -> bool:
        """Whether somebody besides this one reads what it writes."""
        return self._out.get_subscription_count() > 1

    def _count(self, data: bytes) -> None:
        try:
            step = read_step_id(data)
        except ValueError:
            return
        if (step.run, step.step) == (self.next.run, self.next.step) or step.run == self.next.run + 1:
            self.next = StepId(step.run + 1, 0) if step.end else StepId(step.run, step.step + 1)
            self.own += 1

    def _keep(self, data: bytes) -> None:
        if len(data) > len(self._newest) and b'stranger' not in data and not self.said:
            self._newest = data

    def listen(self, seconds: float) -> None:
        """Hear what is said meanwhile."""
        deadline = time.monotonic() + seconds
        while (left := deadline - time.monotonic()) > 0.0:
            self._executor.spin_once(timeout_sec=left)

    def speak(self, kind: Kind, *, catch_up: bool) -> None:
        """Say something of a kind, a few times."""
        while catch_up and self.said < self.own:
            self._out.publish(b'\x00\x01\x00\x00')
            self.said += 1
        for later in range(VOLLEY):
            step = StepId(self.next.run, self.next.step + later)
            self._out.publish(kind(deserialize_message(self._newest, self._kind), step))
            self.said += 1

    def close(self) -> None:
        """Leave."""
        self._executor.shutdown()
        self._node.destroy_node()
        self._context.try_shutdown()


def experiment(folder: Path, rate: float, domain: int | None = None) -> subprocess.Popen[str]:
    """Start a rig that times forty swings at one speed: 80 s."""
    protocol = folder.parent / 'protocol.yaml'
    protocol.write_text(yaml.safe_dump({'speeds': ['2640 rpm'], 'swings': 1, 'repeats': 40}), encoding='utf-8')
    own = {} if domain is None else {'ROS_DOMAIN_ID': str(domain)}
    command = [sys.executable, '-m', 'kapitsa_ros', 'experiment', '--bags', str(folder), '--rate', str(rate)]
    return subprocess.Popen(  # noqa: S603
        [*command, '--protocol', str(protocol), '--json'],
        env=os.environ | own,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        errors='replace',
    )


def outcome(process: subprocess.Popen[str], folder: Path, undisturbed: Path) -> tuple[str, str]:
    """Return how an experiment ended, and what it said."""
    result, said = process.communicate(timeout=240.0)
    lines = [line for line in said.splitlines() if line.startswith('kapitsa: ')]
    last = lines[-1] if lines else ''
    if 'Traceback' in said:
        return 'traceback', said[-2000:]
    if process.returncode == 2:
        sys.exit(said)
    if process.returncode:
        return ('ended and said' if last.startswith('kapitsa: error: ') else 'ended without a word'), last
    same = all(
        (folder / file.relative_to(undisturbed)).read_bytes() == file.read_bytes()
        for file in undisturbed.rglob('*')
        if file.is_file()
    )
    of_bags, printed = analyse_bags(sorted(undisturbed.glob('run_*'))), json.loads(result)
    same = same and all(printed[name] == of_bags[name] for name in ('omega_crit_rpm', 'omega_crit_interval_rpm'))
    return ('ignored' if same else 'changed'), last


def attack(
    topic: str, rate: float, undisturbed: Path, kinds: list[str], *, catch_up: bool
) -> dict[str, tuple[str, str]]:
    """Disturb one rig by one kind after another until it ends; return the outcome of each kind that was said."""
    tried: list[str] = []
    domain = random.randrange(60, 101)  # noqa: S311  # far from those that rigs take for themselves
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / 'bags'
        stranger = Stranger(domain, topic)
        process = experiment(folder, rate, domain)
        try:
            while process.poll() is None and not stranger.is_ready:
                stranger.listen(0.02)
            stranger.join()
            while process.poll() is None and not stranger.is_heard:
                stranger.listen(0.02)
            for kind in kinds:
                if process.poll() is not None:
                    break
                stranger.speak(KINDS[kind], catch_up=catch_up)
                tried.append(kind)
                stranger.listen(1.0 if rate else 0.02)
            while process.poll() is None:
                stranger.listen(0.1)
        finally:
            stranger.close()
            if process.poll() is None:
                process.terminate()
        how, line = outcome(process, folder, undisturbed)
    if not tried and how == 'ignored':
        return {}  # the rig was over before the stranger had found it
    if not tried:
        sys.exit(f'{topic}: the rig ended before anything was said: {line}')
    ended = how != 'ignored'
    print(f'{topic}, rate {rate:g}: {len(tried)} kinds up to {tried[-1:]}: {how}: {line[:200]}', file=sys.stderr)
    return {kind: (how if ended and kind == tried[-1] else 'ignored', line) for kind in tried}


if __name__ == '__main__':
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--topic', choices=list(CLASSES), action='append', help='(several may be given)')
    parser.add_argument('--rate', type=float, action='append', help='(several may be given)')
    parser.add_argument('--catch-up', action='store_true', help='count publications along with the writer')
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        undisturbed = Path(name) / 'undisturbed'
        reference = experiment(undisturbed, 0.0)
        if outcome(reference, undisturbed, undisturbed)[0] != 'ignored':
            sys.exit('the undisturbed experiment failed')
        counts: dict[str, int] = {}
        for topic in options.topic or CLASSES:
            for rate in options.rate or (0.0, 1.0):
                left, found, rigs = list(KINDS), {}, 0
                while left:
                    found |= attack(topic, rate, undisturbed, left, catch_up=options.catch_up)
                    left = [kind for kind in left if kind not in found]
                    rigs += 1
                ways = [how for how, _ in found.values()]
                print(
                    f'{topic:18} rate {rate:g}: ' + ', '.join(f'{how} {ways.count(how)}' for how in sorted(set(ways))),
                    f'({rigs} rigs)',
                )
                for line in sorted(
                    {f'{kind}: {how}: {said}' for kind, (how, said) in found.items() if how != 'ignored'}
                    | {said for _, said in found.values() if said}
                ):
                    print(f'    {line[:300]}', flush=True)
                for how in ways:
                    counts[how] = counts.get(how, 0) + 1
        print('all: ' + ', '.join(f'{how} {count}' for how, count in counts.items()))
        sys.exit(any(how in counts for how in ('changed', 'traceback', 'ended without a word')))
