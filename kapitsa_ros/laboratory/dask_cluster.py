"""A Dask cluster as the workers of a campaign."""

from __future__ import annotations

from collections import deque
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

from kapitsa_ros.extras import import_of_extra
from kapitsa_ros.laboratory.campaign import AHEAD
from kapitsa_ros.laboratory.errors import ClusterError
from kapitsa_ros.versions import versions

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from kapitsa_ros.laboratory.campaign import Batch, Outcome

_PATIENCE = '10s'


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
            The scheduler is gone, or a batch has ended several workers.

        """
        from distributed import KilledWorker  # type: ignore[import-not-found,import-untyped,unused-ignore]  # noqa: PLC0415
        from distributed.client import FutureCancelledError  # noqa: PLC0415

        with self._client:
            under_way: deque[Any] = deque()
            try:
                for batch in batches:
                    under_way.append(self._client.submit(function, batch, pure=False))
                    if len(under_way) > AHEAD * self.count:
                        yield under_way.popleft().result()
                while under_way:
                    yield under_way.popleft().result()
            except KilledWorker as error:
                raise ClusterError(f'a batch ended its workers, one after the other ({error})') from error
            except (FutureCancelledError, OSError) as error:
                raise ClusterError(
                    f'the Dask scheduler at {self._address} is gone: what was finished is kept'
                ) from error

    def _refuse_other_versions(self) -> None:
        ours = versions()
        for worker, theirs in self._client.run(versions).items():
            if theirs != ours:
                pairs = [
                    f'{name} {theirs.get(name)} for {here}' for name, here in ours.items() if theirs.get(name) != here
                ]
                raise ClusterError(f'the worker {worker} has other versions: {", ".join(pairs)}')
