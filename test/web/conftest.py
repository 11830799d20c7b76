"""A bench in a browser, as users start it: one for all tests of a file."""

import json
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from http.client import HTTPConnection
from pathlib import Path
from typing import Any

import pytest

PATIENCE = 60.0


@dataclass
class Server:
    """A command that runs, and serves pages."""

    process: subprocess.Popen[str]
    url: str
    folder: Path

    def ask(self, path: str = '', method: str = 'GET', body: str = '', **headers: str) -> tuple[int, bytes]:
        connection = HTTPConnection(self.url.removeprefix('http://').partition('/')[0], timeout=PATIENCE)
        connection.request(method, f'/{path}', body=body, headers=headers)
        answer = connection.getresponse()
        try:
            return answer.status, answer.read()
        finally:
            connection.close()

    def get(self, path: str = '', **headers: str) -> tuple[int, str]:
        status, body = self.ask(path, **headers)
        return status, body.decode()

    def end(self) -> str:
        """Interrupt it; return what it had to say."""
        self.process.send_signal(signal.SIGINT)
        left, _ = self.process.communicate(timeout=PATIENCE)
        assert self.process.returncode == 0
        return left


def serve(folder: Path, name: str, *arguments: object, **options: Any) -> Server:
    """Start a command that prints `NAME: URL` first."""
    command = [sys.executable, '-m', 'kapitsa_ros', *map(str, arguments), '--port', '0']
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, **options)
    assert process.stdout is not None
    first = process.stdout.readline()
    found = re.fullmatch(rf'{name}: (http://127\.0\.0\.1:\d+/\S*)\n', first)
    assert found, first
    return Server(process, found[1], folder)


@pytest.fixture(scope='session')
def serving() -> Callable[..., Server]:
    return serve


@dataclass
class Bench(Server):
    """A `kapitsa bench --web` that runs."""

    @property
    def link(self) -> str:
        return self.url.replace('http', 'ws', 1) + 'bench'

    def wait(self) -> None:
        """Wait until there is a run, and no page of an earlier test."""
        deadline = time.monotonic() + PATIENCE
        while (health := self.get('health'))[0] != 200 or json.loads(health[1])['pages']:
            assert time.monotonic() < deadline
            assert self.process.poll() is None
            time.sleep(0.05)


@pytest.fixture(scope='module')
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Bench]:
    folder = tmp_path_factory.mktemp('bench')
    command = ['bench', '--web', '--no-open', '--bags', folder / 'runs', '--table', folder / 'mine.csv']
    server = serve(folder, 'bench', *command, '--instruments', 'ideal')
    running = Bench(server.process, server.url, folder)
    try:
        running.wait()
        yield running
        assert f'{folder / "runs"}: kapitsa analyse' in running.end()
    finally:
        running.process.kill()
        running.process.wait()
