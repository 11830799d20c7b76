"""A Dask cluster as the workers of a campaign."""

from __future__ import annotations

from contextlib import ExitStack
from typing import TYPE_CHECKING

from kapitsa_ros.laboratory.errors import ClusterError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from kapitsa_ros.laboratory.campaign import Outcome

_PATIENCE = '10s'


class DaskCluster:
    """The workers of a running Dask scheduler; each needs this package installed.

    Raises
    ------
    ClusterError
        The `campaign` extra is not installed, nobody answers at the address, or there are no workers.

    """

    def __init__(self, address: str) -> None:
        try:
            from distributed import Client  # type: ignore[import-not-found,import-untyped,unused-ignore]  # noqa: PLC0415
        except ImportError as error:
            raise ClusterError('--scheduler needs Dask: install kapitsa_ros[campaign]') from error
        try:
            self._client = Client(address, timeout=_PATIENCE)
        except (OSError, ValueError) as error:
            raise ClusterError(f'no Dask scheduler answers at {address} ({error})') from error
        with ExitStack() as failed_start:
            failed_start.callback(self._client.close)
            self.count = sum(self._client.nthreads().values())
            """How many experiments are under way at once."""
            if not self.count:
                raise ClusterError(f'the Dask scheduler at {address} has no workers: start one')
            failed_start.pop_all()

    def map(self, function: Callable[[int], Outcome], seeds: Iterable[int]) -> Iterator[Outcome]:
        """Apply a function to many seeds; outcomes come in the order of the seeds."""
        with self._client:
            for future in self._client.map(function, list(seeds), pure=False):
                yield future.result()
