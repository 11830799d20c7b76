"""The rig for Python programs: a context that starts, drives, reads and stops the graph."""

from __future__ import annotations

import threading
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, Self

from kapitsa_ros.address_space import OF_A_RIG, refuse_small_address_space
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.configuration.step_parameters import StepParameters
from kapitsa_ros.instruments.settings import Instruments
from kapitsa_ros.network.registry import CLIENT, ROLE_NAMES
from kapitsa_ros.operator.protocol import MANUAL
from kapitsa_ros.operator.requests import check_release, check_speed
from kapitsa_ros.physics.jigsaw_parameters import MAX_SPEED
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.quantities import to_si
from kapitsa_ros.rig.domain import reserved_domain
from kapitsa_ros.rig.environment import on_loopback
from kapitsa_ros.rig.errors import UsageError
from kapitsa_ros.rig.fork_server_process import fork_server
from kapitsa_ros.rig.node_group import NodeGroup
from kapitsa_ros.rig.setup import Setup, parameters
from kapitsa_ros.rig.shared_memory import removing_stale_segments
from kapitsa_ros.rig.simulation_control import SimulationControl
from kapitsa_ros.rig.waiting import wait_until
from kapitsa_ros.ros.rig_client import TOPIC_NAMES, RigClient
from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from types import TracebackType

    from kapitsa_ros.quantities import AnyQuantity
    from kapitsa_ros.rig.node_process import NodeProcess
    from kapitsa_ros.ros.rig_client import News

PATIENCE = 30.0
"""Seconds of wall time for which an answer is waited for."""


class Rig:
    """All nodes of the laboratory, in a domain and processes of their own. A context: on leaving it, none is left.

    Several rigs may run in one process at the same time.

    Parameters
    ----------
    preset
        The plant: the name of a preset, as in `kapitsa experiment --help`, the path of a file, or its parameters.
    instruments
        The instruments: the name of a set, the path of a file, or their settings.
    seed
        Of all chance in the rig.
    rate
        Simulated over wall seconds; 0: as fast as it can.
    nodes
        Roles to start; None: all seven. Those left out are somebody else's: the rig waits until they have joined.
    domain
        ROS domain; None: that of ROS_DOMAIN_ID, or a free one.
    bags
        Folder for the recorded runs; None: a temporary one, which goes with the rig.
    protocol
        `manual`, or what the operator is to carry out.
    composed
        Whether the nodes share one process, which takes less of the machine; its end is that of all.
    steps
        How simulated time is divided between the nodes; None: as by default. Longer steps take less of the machine.

    Raises
    ------
    AddressSpaceError
        On entering: the shell allows less memory than nodes take.
    RigError
        On entering: the domain is taken, or the rig is entered already. From any method: a node died, the message names
        it and its last lines; or the rig is not entered, or has been left, which `latest` alone allows.
    NodeError
        Once the nodes have left, and on leaving: of what was heard, somebody else has said some, too.
    TimeoutError
        From any method that waits: what was waited for did not come.

    """

    def __init__(  # noqa: PLR0917  # the order is the contract's
        self,
        preset: str | Path | Plant = 'ideal',
        instruments: str | Path | Instruments = '1997',
        seed: int = 1,
        rate: float = 0.0,
        nodes: Sequence[str] | None = None,
        domain: int | None = None,
        *,
        bags: str | Path | None = None,
        protocol: str | Path = MANUAL,
        composed: bool = False,
        steps: StepParameters | None = None,
    ) -> None:
        self._roles = ROLE_NAMES if nodes is None else tuple(nodes)
        if unknown := set(self._roles) - set(ROLE_NAMES):
            raise UsageError(f'nodes: {", ".join(sorted(unknown))} unknown: choose from {", ".join(ROLE_NAMES)}')
        self._preset, self._instruments, self._protocol = preset, instruments, str(protocol)
        self._seed, self._rate, self._requested_domain = seed, rate, domain
        self._given_bags, self._composed = bags, composed
        self._steps = StepParameters() if steps is None else steps
        self._stack: ExitStack | None = None
        """What ends with the rig; None: it does not run."""
        self._has_run = False
        self._woken = threading.Event()
        """Set: `news` is not to wait."""
        self.domain: int
        """ROS domain, for nodes that are to join."""
        self.bags: Path
        """Folder of the recorded runs."""
        self._client: RigClient
        self._nodes: NodeGroup

    def __enter__(self) -> Self:
        """Start the nodes."""
        if self._stack is not None:
            raise UsageError('this rig is entered already: make another, several run at the same time')
        refuse_small_address_space(OF_A_RIG)
        with ExitStack() as stack:
            stack.enter_context(fork_server())  # what nodes are forked from loads while the rest is made
            folder = self._given_bags or stack.enter_context(TemporaryDirectory(prefix='kapitsa-'))
            self.bags = Path(folder)
            setup = Setup(
                plant=self._preset if isinstance(self._preset, Plant) else load_preset(self._preset),
                instruments=self._instruments
                if isinstance(self._instruments, Instruments)
                else load_instruments(self._instruments),
                protocol=self._protocol,
                seed=self._seed,
                rate=self._rate,
                steps=self._steps,
                bags=self.bags,
            )
            values = parameters(setup)
            stack.enter_context(removing_stale_segments())
            self.domain = stack.enter_context(reserved_domain(self._requested_domain))
            with on_loopback():
                client = RigClient(self.domain)
            self._client = stack.enter_context(client)
            expected = [*values['expect'], CLIENT.name]
            self._nodes = stack.enter_context(
                NodeGroup(self._roles, values | {'expect': expected}, self.domain, composed=self._composed)
            )
            self._stack, self._has_run = stack.pop_all(), True
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop the nodes."""
        stack, self._stack = self._stack, None
        if stack is not None:
            has_failed = self._nodes.has_failed  # then a node has told what there was to tell
            stack.__exit__(kind, error, trace)
            if error is None and not has_failed:
                self._client.refuse_disputed()

    @property
    def processes(self) -> dict[str, NodeProcess]:
        """The nodes' processes by role, composed the same for each; those that are somebody else's are not there."""
        self._refuse_unless_running()
        return {role: self._nodes[role] for role in self._roles}

    def request_speed(self, rpm: AnyQuantity) -> None:
        """Ask the operator for a forcing speed: RPM as on the dial, or with a unit as in `'37.3 Hz'`.

        Raises
        ------
        QuantityError
            It is no speed.
        RequestError
            The jigsaw cannot turn so.

        """
        speed = to_si('speed', rpm, 'rad/s', RPM)
        check_speed(speed, MAX_SPEED)
        self._ask('operator/speed', speed)

    def release(self, angle: AnyQuantity) -> None:
        """Ask the operator to catch the pendulum and let it go from an angle: rad, or with a unit as in `'7 deg'`.

        Raises
        ------
        QuantityError
            It is no angle.
        RequestError
            The angle is not within a quarter turn of upright.

        """
        radians = to_si('angle', angle, 'rad')
        check_release(radians)
        self._ask('operator/release', radians)

    def wait_for(self, topic: str, predicate: Callable[[Any], bool] | None = None, timeout: float = PATIENCE) -> Any:
        """Return the next message on a topic that fits.

        Each message is given once: what came since the last call counts, so nothing is missed between two calls (of a
        topic that nobody reads the newest 1000 messages are kept). Silent steps are passed over.

        Parameters
        ----------
        topic
            One of `operator/command`, `jigsaw/pivot`, `pendulum/motion`, `strobe/reading`, `stopwatch/reading`,
            `analyser/result`.
        predicate
            Called with the message; None: any fits.
        timeout
            Seconds of wall time.

        Returns
        -------
        Command, Samples, StrobeReading, StopwatchReading or dict
            The message as the rooms without ROS have it, SI units; of `analyser/result` the values by name.

        """
        name = _known(topic)
        what = f'a message on {name} that fits'
        return self._until(lambda: self._client.take(name, predicate), timeout, what, [name])

    def news(
        self, timeout: float = PATIENCE, topics: Sequence[str] = TOPIC_NAMES, *, awaited: Sequence[str] | None = None
    ) -> list[News]:
        """Return all that came since the last call, in the order of its steps.

        Parameters
        ----------
        timeout
            Seconds of wall time to wait for the first message; without one the list is empty, as after `wake`.
        topics
            Of those of `wait_for`.
        awaited
            Those of `topics` whose messages end the wait; None: all. To be woken for each message of a step takes time.

        """
        names = [_known(topic) for topic in topics]
        ending = names if awaited is None else [_known(topic) for topic in awaited]

        def found() -> list[News] | None:
            woken = self._woken.is_set()
            if not (woken or self._client.has_unread(ending)):
                return None
            news = self._client.take_all(names)
            if not (news or woken):  # somebody else's, that are no messages
                return None
            self._woken.clear()
            return news

        try:
            news: list[News] = self._until(found, timeout, 'news', ending)
        except TimeoutError:
            return self._client.take_all(names)
        return news

    def wake(self) -> None:
        """Have a call of `news` return, one under way in another thread or else the next, with what there is."""
        self._woken.set()
        if self._stack is not None:
            self._client.wake()

    def latest(self, topic: str) -> Any:
        """Return the newest message on a topic of `wait_for`, read or not; None where there is none yet."""
        if not self._has_run:
            self._refuse_unless_running()
        if self._nodes.check():
            self._client.refuse_disputed()
        self._client.check()
        return self._client.latest(_known(topic))

    def pause(self) -> None:
        """Let time stand still; when this returns, the last step has come through."""
        self._control.pause()

    def resume(self) -> None:
        """Let time run again."""
        self._control.resume()

    def step(self, count: int = 1) -> None:
        """Make some steps of a paused rig; when this returns, they have come through."""
        self._control.step(count)

    def set_rate(self, rate: float) -> None:
        """Change simulated over wall seconds; 0: as fast as it can."""
        self._control.set_rate(float(rate))

    def reset(self) -> None:
        """End the run under way and open the next, with a bag of its own.

        When this returns, requests go to the new run, and nothing but the result is left of what the earlier one said.
        """
        self._control.reset()

    @property
    def reset_runs(self) -> tuple[int, ...]:
        """Numbers of the runs that a reset has ended, whoever in the domain has called for it."""
        self._refuse_unless_running()
        return tuple(self._nodes.reset_runs())

    @property
    def _control(self) -> SimulationControl:
        self._refuse_unless_running()
        return SimulationControl(self._client, lambda found, what: self._until(found, PATIENCE, what))

    def _ask(self, topic: str, value: float) -> None:
        if 'operator' in self._roles and self._protocol != MANUAL:
            raise UsageError(
                f'{topic}: the operator carries out the protocol {self._protocol}; give protocol={MANUAL!r}'
            )
        self._until(lambda: self._client.is_heard(topic) or None, PATIENCE, f'somebody who takes {topic}')
        self._client.ask(topic, value)

    def _refuse_unless_running(self) -> None:
        if self._stack is None:
            raise UsageError('this rig does not run: use it within `with Rig() as rig:`')

    def _until(self, found: Callable[[], Any], timeout: float, what: str, topics: Sequence[str] | None = None) -> Any:
        self._refuse_unless_running()
        return wait_until(found, self._client, self._nodes, timeout, what, topics)


def _known(topic: str) -> str:
    name = topic.removeprefix('/')
    if name not in TOPIC_NAMES:
        raise UsageError(f'topic {topic!r} is none of {", ".join(TOPIC_NAMES)}')
    return name
