"""A server that is interrupted while its nodes are still to come."""

import os
import pty
import select
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip('uvicorn')
PATIENCE = 180.0


def read_until(terminal: int, text: bytes) -> bytes:
    """Read what comes on a terminal, until a text or until nobody writes there any more."""
    seen = b''
    while text not in seen:
        assert select.select([terminal], [], [], PATIENCE)[0], seen
        try:
            seen += os.read(terminal, 4096)
        except OSError:
            break
    return seen


@pytest.mark.parametrize('command', ['bench', 'serve'])
def test_ctrl_c_does_not_wait_for_kernels_to_be_compiled(
    command: str, serving: Callable[..., Any], tmp_path: Path
) -> None:
    rods = tmp_path / 'class.yaml'
    rods.write_text('benches: 1\nseed: 1\n')
    arguments = {
        'bench': ('bench', 'bench', '--web', '--no-open', '--table', tmp_path / 'mine.csv'),
        'serve': ('class', 'serve', '--no-open', '--class', rods),
    }[command]
    terminal, stderr = pty.openpty()
    server = serving(
        tmp_path,
        *arguments,
        *('--bags', tmp_path / 'runs'),
        env=os.environ | {'NUMBA_OPT': '1', 'NUMBA_CACHE_DIR': str(tmp_path / 'kernels')},
        stderr=stderr,
    )
    os.close(stderr)
    try:
        assert b'once after an installation' in read_until(terminal, b'installation')
        server.end()
        assert b'compiled in' not in read_until(terminal, b'compiled in')
    finally:
        os.close(terminal)
