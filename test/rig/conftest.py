"""The command line as users run it, and graphs of processes."""

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from kapitsa_ros.nodes.observer import Observer
from kapitsa_ros.rig.domain import reserved_domain
from kapitsa_ros.rig.environment import on_loopback


@dataclass(frozen=True)
class Answer:
    status: int
    out: str
    err: str

    @property
    def json(self) -> dict[str, Any]:
        assert self.status == 0, self.err
        return json.loads(self.out)


@pytest.fixture(scope='session')
def kapitsa() -> Callable[..., Answer]:
    """Run `kapitsa` with arguments."""

    def run(*arguments: object, env: dict[str, str] | None = None) -> Answer:
        command = [sys.executable, '-m', 'kapitsa_ros.rig', *map(str, arguments)]
        done = subprocess.run(
            command, env=os.environ | (env or {}), capture_output=True, text=True, timeout=120, check=False
        )
        return Answer(done.returncode, done.stdout, done.stderr)

    return run


@pytest.fixture(scope='session')
def recorded(kapitsa: Callable[..., Answer], tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """An experiment on the ideal plant with the instruments of 1997, seed 1: its folder and its JSON."""
    bags = tmp_path_factory.mktemp('recorded') / 'A'
    return bags, kapitsa('experiment', '--preset', 'ideal', '--seed', 1, '--bags', bags, '--json').json


@pytest.fixture
def domain() -> Iterator[int]:
    with reserved_domain() as number:
        yield number


@pytest.fixture
def observer(domain: int) -> Iterator[Observer]:
    with on_loopback():
        listening = Observer(domain)
    with listening:
        yield listening


@pytest.fixture(scope='session')
def shared_memory_of() -> Callable[[Iterable[int]], set[Path]]:
    """Return the files of the shared memory that DDS has made for processes, by their ids."""

    def find(pids: Iterable[int]) -> set[Path]:
        maps = [Path(f'/proc/{pid}/maps').read_text() for pid in pids]
        return {Path(found) for text in maps for found in re.findall(r'/\S+/fastrtps_[0-9a-f]{16}', text)}

    return find


@pytest.fixture
def busy() -> Iterator[None]:
    """Keep both cores busy with something else."""
    spinners = [subprocess.Popen([sys.executable, '-S', '-E', '-c', 'while True: pass']) for _ in range(2)]
    yield
    for spinner in spinners:
        spinner.kill()
        spinner.wait()
