"""A campaign on a Dask cluster of real processes: what becomes of it where a worker or the scheduler is killed."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest

import kapitsa_ros as kr
from kapitsa_ros.laboratory import dask_cluster
from kapitsa_ros.laboratory.campaign import Outcome
from kapitsa_ros.laboratory.errors import ClusterError

pytest.importorskip('distributed')
parquet = pytest.importorskip('pyarrow.parquet')
pytestmark = pytest.mark.slow
EXPERIMENTS = 120


class DaskProcesses:
    """A scheduler and two workers on this machine, which hear this machine alone."""

    def __init__(self, folder: Path, stack: ExitStack, eventually: Callable[[Callable[[], bool]], None]) -> None:
        self._folder, self._stack = folder, stack
        told = folder / 'scheduler.json'
        self.scheduler = self._start('dask_scheduler', '--port', '0', '--scheduler-file', str(told))
        eventually(told.exists)
        of_worker = ('--scheduler-file', str(told), '--nthreads', '1', '--no-nanny', '--local-directory', str(folder))
        self.workers = [self._start('dask_worker', *of_worker) for _ in range(2)]
        distributed = sys.modules['distributed']
        with distributed.Client(scheduler_file=str(told)) as client:
            client.wait_for_workers(2)
            self.address = client.scheduler.address

    def _start(self, module: str, *arguments: str) -> subprocess.Popen[bytes]:
        own = ('--host', '127.0.0.1', '--no-dashboard')
        command = [sys.executable, '-m', f'distributed.cli.{module}', *own, *arguments]
        process = subprocess.Popen(command, cwd=self._folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self._stack.callback(process.wait)
        self._stack.callback(process.kill)
        return process


@pytest.fixture
def cluster(tmp_path: Path, eventually: Callable[[Callable[[], bool]], None]) -> Iterator[DaskProcesses]:
    with ExitStack() as stack:
        yield DaskProcesses(tmp_path, stack, eventually)


def killing(process: subprocess.Popen[bytes]) -> Callable[[Iterator[Outcome], int], Iterable[Outcome]]:
    """Kill a process once the first outcomes have come."""

    def pass_on(outcomes: Iterator[Outcome], _: int) -> Iterator[Outcome]:
        for number, outcome in enumerate(outcomes):
            if number == 20:
                os.kill(process.pid, signal.SIGKILL)
            yield outcome

    return pass_on


def test_a_killed_worker_changes_nothing(cluster: DaskProcesses, tmp_path: Path) -> None:
    there, here = tmp_path / 'there.parquet', tmp_path / 'here.parquet'
    on_cluster = {'scheduler': cluster.address, 'progress': killing(cluster.workers[0])}
    kr.campaign('ideal', experiments=EXPERIMENTS, output=there, **on_cluster)
    assert cluster.workers[0].wait() == -signal.SIGKILL
    kr.campaign('ideal', experiments=EXPERIMENTS, output=here)
    assert parquet.read_table(there).equals(parquet.read_table(here))


def test_a_cluster_without_workers_is_not_waited_for_for_ever(
    cluster: DaskProcesses, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dask_cluster, '_LOOKED_EVERY', 0.5)

    def killing_all(outcomes: Iterator[Outcome], _: int) -> Iterator[Outcome]:
        for number, outcome in enumerate(outcomes):
            if number == 20:
                for worker in cluster.workers:
                    worker.kill()
            yield outcome

    output = tmp_path / 'there.parquet'
    with pytest.raises(ClusterError, match='has no workers any more: what was finished is kept'):
        kr.campaign(
            'ideal', experiments=4 * EXPERIMENTS, output=output, scheduler=cluster.address, progress=killing_all
        )
    assert any(output.with_name(f'{output.name}.parts').iterdir())


def test_what_was_finished_outlives_the_scheduler(cluster: DaskProcesses, tmp_path: Path) -> None:
    output, here = tmp_path / 'there.parquet', tmp_path / 'here.parquet'
    with pytest.raises(ClusterError, match='is gone: what was finished is kept'):
        kr.campaign(
            'ideal',
            experiments=EXPERIMENTS,
            output=output,
            scheduler=cluster.address,
            progress=killing(cluster.scheduler),
        )
    assert not output.exists()
    assert any(output.with_name(f'{output.name}.parts').iterdir())
    kr.campaign('ideal', experiments=EXPERIMENTS, output=output, resume=True)
    kr.campaign('ideal', experiments=EXPERIMENTS, output=here)
    assert parquet.read_table(output).equals(parquet.read_table(here))
