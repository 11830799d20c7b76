"""A bench in a browser, as users start it: one for all tests of a file."""

import json
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from http.client import HTTPConnection
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

import pytest

with suppress(ImportError):
    from websockets.exceptions import ConnectionClosed
    from websockets.sync.client import connect

PATIENCE = 180.0


@dataclass
class Server:
    """A command that runs, and serves pages."""

    process: subprocess.Popen[str]
    url: str
    folder: Path

    @property
    def link(self) -> str:
        return f'{self.url.replace("http", "ws", 1).partition("?")[0]}bench'

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


def serve(folder: Path, name: str, *arguments: object, port: str = '0', **options: Any) -> Server:
    """Start a command that prints `NAME: URL` first."""
    command = [sys.executable, '-m', 'kapitsa_ros', *map(str, arguments), '--port', port]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, **options)
    assert process.stdout is not None
    first = process.stdout.readline()
    found = re.fullmatch(rf'{name}: (http://127\.0\.0\.1:\d+/\S*)\n', first)
    assert found, first
    return Server(process, found[1], folder)


@pytest.fixture(scope='module')
def serving() -> Iterator[Callable[..., Server]]:
    """Start servers; none of them outlives the tests of a file."""
    servers = []

    def start(*arguments: Any, **options: Any) -> Server:
        servers.append(serve(*arguments, **options))
        return servers[-1]

    yield start
    for server in servers:
        server.process.kill()
        server.process.wait()


@pytest.fixture(scope='session', autouse=True)
def _patient_expectations() -> None:
    """Have what is expected of a page wait as all else does: a machine under load takes more than the 5 s it would."""
    with suppress(ImportError):
        from playwright.sync_api import expect

        expect.set_options(timeout=1000 * PATIENCE)


class Page:
    """A client of the bench that is no browser."""

    def __init__(self, server: Server, key: str, **query: str) -> None:
        self._stack = ExitStack()
        address = f'{server.link}?{urlencode({"key": key} | query)}'
        self.link: Any = self._stack.enter_context(connect(address, max_size=None, max_queue=None))
        self.told: dict[str, dict[str, Any]] = {}
        self.motions = 0

    def close(self) -> None:
        self._stack.close()

    def ask(self, name: str, value: Any = None) -> None:
        self.link.send(json.dumps({'do': name} if value is None else {'do': name, 'value': value}))

    def until(self, true: Callable[[], Any]) -> None:
        deadline = time.monotonic() + PATIENCE
        while not true():
            frame = self.link.recv(timeout=deadline - time.monotonic())
            if isinstance(frame, bytes):
                self.motions += 1
            else:
                report = json.loads(frame)
                self.told[report['kind']] = report

    def refused(self, why: str) -> None:
        self.until(lambda: why in self.told.get('refusal', {}).get('why', ''))

    def closed(self) -> tuple[int, str]:
        with pytest.raises(ConnectionClosed) as closed:
            self.until(lambda: False)
        assert closed.value.rcvd is not None
        return closed.value.rcvd.code, closed.value.rcvd.reason

    def works(self) -> bool:
        return bool(self.told.get('rig', {}).get('works'))


@pytest.fixture
def link_to() -> Iterator[Callable[..., Page]]:
    """Open links to benches."""
    pytest.importorskip('websockets')
    pages = []

    def open_(server: Server, key: str, **query: str) -> Page:
        pages.append(Page(server, key, **query))
        return pages[-1]

    yield open_
    for page in pages:
        page.close()


@dataclass
class Bench(Server):
    """A `kapitsa bench --web` that runs."""

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
