"""The page of a bench in headless Chromium: from command to motion, frames a second, and from a key to its effect.

Rig, server and browser share the machine. The browser runs before the command is given, and shows an empty page: its
own start takes as long as that of a rig. The effect of a key is the next value of the dial, which the server tells.
"""

from __future__ import annotations

import json
import shutil
import signal
import statistics
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from measure import REPEATS
from playwright.sync_api import sync_playwright

if TYPE_CHECKING:
    from collections.abc import Iterator

KEYS = 21
WATCHED = 10.0
"""Wall seconds in which frames are counted."""
IDLE = 3.0
"""Wall seconds after which a new page of the browser itself is at rest."""
LOOKED_EVERY = 20
"""ms between two looks whether the page moves: asked in each frame, frames are made for it."""
PATIENCE = 120_000
"""ms."""
MOVES = "() => /^run 1 · (?!0\\.0 )/.test(document.getElementById('status').textContent)"
WATCH = """() => {
  const reading = document.getElementById('dial-reading');
  window.delay = null;
  addEventListener('keydown', () => {
    const pressed = performance.now();
    const observer = new MutationObserver(() => { observer.disconnect(); window.delay = performance.now() - pressed; });
    observer.observe(reading, {childList: true, characterData: true, subtree: true});
  }, {once: true, capture: true});
}"""


@contextmanager
def moving_page(browser: Any) -> Iterator[tuple[Any, float]]:
    """Start a bench and open its page; give the page, and the wall seconds until something moved on it."""
    page = browser.new_page()
    page.set_default_timeout(PATIENCE)
    page.goto('about:blank')
    page.wait_for_timeout(1e3 * IDLE)
    with TemporaryDirectory() as folder:
        began = time.monotonic()
        command = [sys.executable, '-m', 'kapitsa_ros', 'bench', '--web', '--no-open', '--port', '0']
        command += ['--bags', str(Path(folder, 'runs')), '--table', str(Path(folder, 'table.csv'))]
        server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)  # noqa: S603
        try:
            assert server.stdout is not None  # noqa: S101  # it is a pipe
            address = server.stdout.readline().split()[-1]
            page.goto(address)
            page.wait_for_function(MOVES, polling=LOOKED_EVERY)
            yield page, time.monotonic() - began
            page.close()
        finally:
            server.send_signal(signal.SIGINT)
            server.communicate(timeout=60)


def frames(page: Any) -> int:
    """Return how many frames were drawn so far."""
    return int(page.evaluate('() => Number(document.documentElement.dataset.frames)'))


def key_to_effect(page: Any) -> float:
    """Press a key; return the seconds until its effect is on the page."""
    page.evaluate(WATCH)
    page.keyboard.press(']')
    page.wait_for_function('() => window.delay')
    return float(page.evaluate('() => window.delay')) / 1e3


def main() -> None:
    """Print the claims as JSON."""
    starts, shown, delays = [], [], []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which('chromium'), args=['--disable-gpu'])
        for _ in range(REPEATS):
            with moving_page(browser) as (page, seconds):
                starts.append(seconds)
                delays.append(statistics.median(key_to_effect(page) for _ in range(KEYS)))
                before, began = frames(page), time.monotonic()
                page.wait_for_timeout(1e3 * WATCHED)
                shown.append((frames(page) - before) / (time.monotonic() - began))
        browser.close()
    for work, target, values in (
        ('from kapitsa bench --web to a page that moves', '<= 3 s', starts),
        (f'from a key to its effect on the page, median of {KEYS}', '<= 0.1 s', delays),
    ):
        print(json.dumps({'work': work, 'target': target, 'ours_s': statistics.median(values)}), flush=True)
    work = 'frames a second of a page at rate 1, two cores shared with the rig'
    print(json.dumps({'work': work, 'target': '>= 30', 'ratio': statistics.median(shown)}), flush=True)


if __name__ == '__main__':
    main()
