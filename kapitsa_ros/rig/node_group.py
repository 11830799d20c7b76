"""The processes of a rig: started together, watched, and stopped whatever happens."""

from __future__ import annotations

import select
import signal
import time
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any, Self

from kapitsa_ros.network.registry import KERNEL_NAMES
from kapitsa_ros.rig.errors import RigError
from kapitsa_ros.rig.fork_server_process import fork_server
from kapitsa_ros.rig.node_process import NodeProcess

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from types import TracebackType


GRACE = 2.0
"""Seconds between asking a node to end and ending it."""


HASTE = 1.2
"""The same after something went wrong: the error should reach the caller soon."""


class NodeGroup:
    """The processes of a rig. A context: on leaving it, none is left.

    Parameters
    ----------
    roles
        Of its nodes.
    parameters
        Of all nodes; each takes its own.
    domain
        ROS domain.
    composed
        Whether the nodes share one process.

    """

    def __init__(
        self, roles: Sequence[str], parameters: Mapping[str, Any], domain: int, *, composed: bool = False
    ) -> None:
        self._processes: list[NodeProcess] = []
        self._left: dict[str, float] = {}
        self._server = ExitStack()
        try:
            server = self._server.enter_context(fork_server())
            in_order = sorted(roles, key=lambda role: role in KERNEL_NAMES)
            for together in [roles] if composed and roles else [[role] for role in in_order]:
                self._processes.append(NodeProcess(server, together, parameters, domain))
        except BaseException:
            self.stop(HASTE)
            raise

    def __enter__(self) -> Self:
        """Return the group; its processes run since it was made."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop all."""
        self.stop(GRACE if kind is None else HASTE)

    def __getitem__(self, role: str) -> NodeProcess:
        """Return the process of a role."""
        return next(process for process in self._processes if role in process.roles)

    @property
    def has_failed(self) -> bool:
        """Whether a node ended with an error."""
        return any(process.status() for process in self._processes)

    def check(self) -> bool:
        """Return whether all have ended as they should; False while one runs.

        Raises
        ------
        RigError
            A node died; the message names it and its last lines.

        """
        ended = [(process, process.status()) for process in self._processes]
        failed = [(process, status) for process, status in ended if status]
        # The first may be the cause of all others: they fell with it. One that broke is more telling than one killed.
        for process, status in sorted(failed, key=lambda pair: (pair[0].ended_at, pair[1] < 0)):
            who, lines = process.last_error()
            said = {'node': who, 'lines': f': {lines}' if lines else ''}
            if status < 0:
                raise RigError('{node} was killed by {signal}{lines}', signal=signal.Signals(-status).name, **said)
            raise RigError('{node} died with status {status}{lines}', status=status, **said)
        if any(process.orphaned for process in self._processes):
            raise RigError('the process that the nodes were forked from was killed, and they have left')
        return all(status == 0 for _, status in ended)

    def have_joined(self) -> bool:
        """Whether all have joined their domain."""
        return all(process.has_joined for process in self._processes)

    def who_waits(self) -> str:
        """Return in words who waits for whom; empty if nobody says so."""
        waits = [pair for process in self._processes for pair in process.waits.items()]
        return '; '.join(f'{role} waits for {awaited}' for role, awaited in waits)

    def refusals(self) -> list[str]:
        """Return which nodes have refused what somebody said, and what they said of it."""
        return [f'{role} has {what}' for process in self._processes for role, what in process.refused.items()]

    def held_up(self) -> list[str]:
        """Return which nodes wait for a reader of what they say, or did, and what they said of it."""
        return [f'{role}: {what}' for process in self._processes for role, what in process.held_up.items()]

    def reset_runs(self) -> list[int]:
        """Return the numbers of the runs that were reset, whoever called for it."""
        return [run for process in self._processes for run in process.reset_runs()]

    def refuse_leavers(self, patience: float) -> None:
        """Refuse that a node ended of itself, as after a signal, while others still need it.

        Raises
        ------
        RigError
            One did, longer ago than `patience` seconds.

        """
        now = time.monotonic()
        for process in self._processes:
            if process.status() == 0 and now - self._left.setdefault(process.name, now) > patience:
                raise RigError('{node} was ended before the session was over', node=process.name)

    def wait(self, timeout: float, *news: int) -> bool:
        """Wait until a node ends, a file descriptor of `news` can be read, or the time is over; then check.

        Raises
        ------
        RigError
            A node died.

        """
        statuses = {process.sentinel: process.status() for process in self._processes}
        running = [sentinel for sentinel, status in statuses.items() if status is None]
        if running and not any(statuses.values()):
            _wait_until_readable([*running, *news], timeout)
        return self.check()

    def stop(self, grace: float) -> None:
        """End every node: with SIGINT, and with SIGKILL if it still runs after `grace` seconds."""
        try:
            for number in (signal.SIGCONT, signal.SIGINT):
                for process in self._processes:
                    process.end(number)
            deadline = time.monotonic() + grace
            for process in self._processes:
                _wait_until_readable([process.sentinel], max(0.0, deadline - time.monotonic()))
        finally:  # also where a signal interrupts the wait
            for process in self._processes:
                process.end(signal.SIGKILL)
            for process in self._processes:
                process.close()
            self._processes.clear()
            self._server.close()


def _wait_until_readable(descriptors: Sequence[int], timeout: float) -> None:
    """Wait until one of these file descriptors can be read, or for so many seconds."""
    poll = select.poll()  # `select.select` takes no descriptor above 1023
    for descriptor in descriptors:
        poll.register(descriptor, select.POLLIN)
    poll.poll(1000 * timeout)
