"""A bench in a browser, as users start it: one for all tests of a file."""

import json
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from http.client import HTTPConnection
from pathlib import Path

import pytest

PATIENCE = 60.0


@dataclass
class Bench:
    """A `kapitsa bench --web` that runs."""

    process: subprocess.Popen[str]
    url: str
    folder: Path

    @property
    def link(self) -> str:
        return self.url.replace('http', 'ws', 1) + 'bench'

    def get(self, path: str = '', **headers: str) -> tuple[int, str]:
        connection = HTTPConnection(self.url.removeprefix('http://').strip('/'), timeout=PATIENCE)
        connection.request('GET', f'/{path}', headers=headers)
        answer = connection.getresponse()
        try:
            return answer.status, answer.read().decode()
        finally:
            connection.close()

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
    command = [sys.executable, '-m', 'kapitsa_ros', 'bench', '--web', '--no-open', '--port', '0']
    command += ['--bags', str(folder / 'runs'), '--table', str(folder / 'mine.csv'), '--instruments', 'ideal']
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        first = process.stdout.readline()
        found = re.fullmatch(r'bench: (http://127\.0\.0\.1:\d+/)\n', first)
        assert found, first
        running = Bench(process, found[1], folder)
        running.wait()
        yield running
        process.send_signal(signal.SIGINT)
        left, _ = process.communicate(timeout=PATIENCE)
        assert process.returncode == 0
        assert f'{folder / "runs"}: kapitsa analyse' in left
    finally:
        process.kill()
        process.wait()
