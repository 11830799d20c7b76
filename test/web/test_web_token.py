"""A server beyond loopback, asked with and without its token; here it listens on loopback all the same."""

import asyncio
from http.client import HTTPConnection
from pathlib import Path

import pytest

from kapitsa_ros.bench.notebook import Notebook
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.physics.plant import Plant

pytest.importorskip('starlette')
pytest.importorskip('uvicorn')
from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus

from kapitsa_ros.web.access import Access
from kapitsa_ros.web.bench_setup import BenchSetup
from kapitsa_ros.web.server import application
from kapitsa_ros.web.serving import listen, serving
from kapitsa_ros.web.web_bench import WebBench


def status(here: str, path: str) -> int:
    connection = HTTPConnection(here)
    connection.request('GET', f'/{path}')
    try:
        return connection.getresponse().status
    finally:
        connection.close()


def test_beyond_loopback_nothing_but_what_is_the_same_for_all_is_given_without_the_token(tmp_path: Path) -> None:
    async def ask() -> None:
        instruments = load_instruments('ideal')
        setup = BenchSetup(
            plant=Plant(), shown=Plant(), instruments=instruments, seed=1, rate=1.0, bags=tmp_path / 'runs'
        )
        bench = WebBench(setup, Notebook(tmp_path / 'book.csv'))
        with listen('127.0.0.1', 0) as listening:
            port = listening.getsockname()[1]
            access = Access.of('0.0.0.0', port)  # noqa: S104
            assert access.token
            here = f'127.0.0.1:{port}'
            query = f'?token={access.token}'
            async with serving(application(bench, access), listening):
                asked = {'': 403, query: 200, '?token=wrong': 403, 'book.csv': 403, f'book.csv{query}': 200}
                asked |= {'health': 403, 'static/bench.js': 200, 'words.json?lang=de': 200}
                for path, wanted in asked.items():
                    assert await asyncio.to_thread(status, here, path) == wanted, path
                with pytest.raises(InvalidStatus) as refused:
                    await connect(f'ws://{here}/bench')
                assert refused.value.response.status_code == 403
                async with connect(f'ws://{here}/bench{query}') as link:
                    assert '"kind"' in str(await link.recv())

    asyncio.run(ask())
