"""A Dask cluster as the workers of a campaign."""

from __future__ import annotations

import os
from collections import deque
from contextlib import ExitStack
from functools import partial
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from kapitsa_ros.errors import shorten
from kapitsa_ros.extras import import_of_extra
from kapitsa_ros.laboratory.campaign import AHEAD
from kapitsa_ros.laboratory.errors import ClusterError
from kapitsa_ros.versions import versions

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from kapitsa_ros.laboratory.campaign import Batch, Outcome

_PATIENCE = 10.0
"""Seconds in which a scheduler is to answer."""
_LOOKED_EVERY = 5.0
"""Seconds between two looks whether there are workers."""
_LOOKS_ALONE = 6
"""In a row without one: whoever starts workers anew has had the time to."""


class DaskCluster:
    """The workers of a running Dask scheduler; each needs this package installed, in this version.

    Raises
    ------
    MissingPackageError
        The `campaign` extra is not installed.
    ClusterError
        Nobody answers at the address, there are no workers, or one of them has
        other versions than this program: its digits would not be those of the others.

    """

    def __init__(self, address: str) -> None:
        distributed = import_of_extra('distributed', '--scheduler', 'campaign')
        _refuse_address(address)
        _refuse_other_server(address)
        try:
            self._client = distributed.Client(address, timeout=_PATIENCE, set_as_default=False)  # a program has its own
        except (OSError, ValueError) as error:
            raise ClusterError(f'no Dask scheduler answers at {address} ({error})') from error
        self._address = address
        with ExitStack() as failed_start:
            failed_start.callback(self._client.close)
            self.count = sum(self._client.nthreads().values())
            """How many batches are under way at once."""
            if not self.count:
                raise ClusterError(f'the Dask scheduler at {address} has no workers: start one')
            self._refuse_other_versions()
            failed_start.pop_all()

    def map(self, function: Callable[[Batch], list[Outcome]], batches: Iterable[Batch]) -> Iterator[list[Outcome]]:
        """Apply a function to many batches, which are asked for as they are needed; results come in their order.

        A batch whose worker is lost is given to another.

        Raises
        ------
        ClusterError
            The scheduler is gone, or all workers are; one has other versions; or a batch has ended several.

        """
        from distributed import KilledWorker  # type: ignore[import-not-found,import-untyped,unused-ignore]  # noqa: PLC0415
        from distributed.client import FutureCancelledError  # noqa: PLC0415

        with self._client:
            under_way: deque[Any] = deque()
            checked = partial(of_versions, versions(), function)
            try:
                for batch in batches:
                    under_way.append(self._client.submit(checked, batch, pure=False))
                    if len(under_way) > AHEAD * self.count:
                        yield self._result(under_way.popleft())
                while under_way:
                    yield self._result(under_way.popleft())
            except (ImportError, AttributeError) as error:
                raise ClusterError(f'a worker has not the versions of this program: {error}') from error
            except KilledWorker as error:
                raise ClusterError(f'a batch ended its workers, one after the other ({error})') from error
            except (FutureCancelledError, OSError) as error:
                raise ClusterError(
                    f'the Dask scheduler at {self._address} is gone: what was finished is kept'
                ) from error

    def _result(self, future: Any) -> list[Outcome]:
        """Wait for a batch, while there is a worker, or one may come in the place of one that was lost."""
        alone = 0
        while True:
            try:
                found: list[Outcome] = future.result(timeout=_LOOKED_EVERY)
            except TimeoutError:
                alone = 0 if self._client.nthreads() else alone + 1
                if alone > _LOOKS_ALONE:
                    raise ClusterError(
                        f'the Dask scheduler at {self._address} has no workers any more: what was finished is kept, '
                        'start one and go on by --resume'
                    ) from None
            else:
                return found

    def _refuse_other_versions(self) -> None:
        ours = versions()
        for worker, theirs in self._client.run(versions).items():
            _refuse_versions(f'the worker {worker}', ours, theirs)


def of_versions(ours: dict[str, str], function: Callable[[Batch], list[Outcome]], batch: Batch) -> list[Outcome]:
    """Apply a function to a batch, in a worker, if that has the versions of whoever asks: it may have come late.

    Raises
    ------
    ClusterError
        It has others.

    """
    _refuse_versions('a worker that came later', ours, versions())
    return function(batch)


def _refuse_versions(whose: str, ours: dict[str, str], theirs: dict[str, str]) -> None:
    if theirs != ours:
        pairs = [f'{name} {theirs.get(name)} for {here}' for name, here in ours.items() if theirs.get(name) != here]
        raise ClusterError(f'{whose} has other versions: {", ".join(pairs)}')


def _refuse_other_server(address: str) -> None:
    """Refuse what does not answer as Dask does, before a client is made.

    A client waits for such an answer without end, and one that was never connected is not closed in silence.
    """
    from distributed.utils import LoopRunner  # type: ignore[import-not-found,import-untyped,unused-ignore]  # noqa: PLC0415

    try:
        identity = LoopRunner().run_sync(_identity, address, callback_timeout=_PATIENCE)
    except TimeoutError as error:
        raise ClusterError(f'no Dask scheduler answers at {address}: none in {_PATIENCE:g} s') from error
    except OSError as error:
        raise ClusterError(f'no Dask scheduler answers at {address} ({error})') from error
    except Exception as error:  # such an answer was taken for lengths, names, pickles: each complains in its own way
        kind = type(error).__name__
        raise ClusterError(
            f'no Dask scheduler answers at {address}: what is there speaks otherwise ({kind})'
        ) from error
    if 'workers' not in identity:
        kind = shorten(str(identity['type']), 40)
        raise ClusterError(f'no Dask scheduler is at {address}, but a {kind}: give the address of its scheduler')


async def _identity(address: str) -> dict[str, Any]:
    from distributed import rpc  # type: ignore[import-not-found,import-untyped,unused-ignore]  # noqa: PLC0415

    async with rpc(address) as server:
        found: dict[str, Any] = await server.identity()
        return found


def _refuse_address(address: str) -> None:
    """Refuse what is no HOST:PORT, nor a scheduler of this process, before it is looked for, which would take long."""
    try:
        parts = urlsplit(address if '://' in address else f'tcp://{address}')
        inside = parts.scheme == 'inproc' and parts.path.startswith(f'/{os.getpid()}/')
        usable = inside or (parts.scheme == 'tcp' and bool(parts.hostname) and parts.port is not None)
    except ValueError:
        usable = False
    if not usable:
        raise ClusterError(f'no Dask scheduler can be at {address!r}: give an address such as tcp://127.0.0.1:8786')
