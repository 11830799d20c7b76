"""The pictures of the pages in the README: real servers in Chromium, at three widths, light and dark.

The argument is the folder of a class that `benchmarks/class_of_students.py --keep` has left.
"""

from __future__ import annotations

import base64
import shutil
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from playwright.sync_api import expect, sync_playwright

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

HERE = Path(__file__).resolve().parent
SCREENS = ((1280, 800), (768, 1024), (390, 844))
SCHEMES = ('light', 'dark')
SCALE, GAP, QUALITY = 0.5, 16, 0.8
MONTAGE = """async ({rows, scale, gap, quality}) => {
  const load = async url => {
    const image = new Image();
    image.src = url;
    await image.decode();
    return image;
  };
  const images = await Promise.all(rows.map(row => Promise.all(row.map(load))));
  const canvas = document.createElement('canvas');
  const high = scale * Math.max(...images[0].map(image => image.height)) + gap;
  canvas.width = images[0].reduce((sum, image) => sum + scale * image.width + gap, gap);
  canvas.height = images.length * high + gap;
  const context = canvas.getContext('2d');
  context.imageSmoothingQuality = 'high';
  context.fillStyle = '#808080';
  context.fillRect(0, 0, canvas.width, canvas.height);
  images.forEach((row, line) => {
    let left = gap;
    for (const image of row) {
      context.drawImage(image, left, gap + line * high, scale * image.width, scale * image.height);
      left += scale * image.width + gap;
    }
  });
  return canvas.toDataURL('image/webp', quality);
}"""
PATIENCE = 180_000
"""ms."""
READ = {2240: 3.0, 2640: 2.25, 2780: 2.04}
"""RPM, and the seconds of three swings: the readings of 1997."""
FORCING, FLASHES = 2240, 4460
"""RPM, and flashes a minute: the mark is doubled and drifts."""


@contextmanager
def serving(*arguments: object) -> Iterator[list[str]]:
    """Run a command that serves pages; give the links that it prints."""
    command = [sys.executable, '-m', 'kapitsa_ros', *map(str, arguments), '--no-open', '--port', '0']
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)  # noqa: S603
    try:
        lines = process.stdout or iter(())
        yield [next(lines).split()[-1] for _ in range(2 if arguments[0] == 'serve' else 1)]
    finally:
        process.send_signal(signal.SIGINT)
        process.wait()


def montage(browser: Any, link: str, prepare: Callable[[Any], None]) -> bytes:
    """Return the screens of one page side by side, light above, dark below, as WebP."""
    taken = [[screen(browser, link, prepare, size, scheme) for size in SCREENS] for scheme in SCHEMES]
    page = browser.new_page()
    picture = page.evaluate(MONTAGE, {'rows': taken, 'scale': SCALE, 'gap': GAP, 'quality': QUALITY})
    page.close()
    return base64.b64decode(picture.partition(',')[2])


def screen(browser: Any, link: str, prepare: Callable[[Any], None], size: tuple[int, int], scheme: str) -> str:
    """Return what one screen shows, as the address of its data."""
    width, height = size
    context = browser.new_context(viewport={'width': width, 'height': height}, color_scheme=scheme)
    page = context.new_page()
    page.set_default_timeout(PATIENCE)
    page.goto(link)
    prepare(page)
    taken = base64.b64encode(page.screenshot()).decode()
    context.close()
    return f'data:image/png;base64,{taken}'


def bench(page: Any) -> None:
    """Have the shaft turn, the lamp flash and the rod swing; write down three lines before, unless they are there."""
    expect(page.get_by_test_id('status')).to_contain_text('run', timeout=PATIENCE)
    drawn(page)
    if not page.get_by_role('button', name='strike out line 1').count():
        for forcing, three_swings in READ.items():
            turn(page, forcing, 2 * forcing)
            page.keyboard.press('Space')
            time.sleep(three_swings)
            page.keyboard.press('Space')
            page.keyboard.press('w')
        expect(page.get_by_test_id('fit')).to_contain_text('95 % interval', timeout=PATIENCE)
    turn(page, FORCING, FLASHES)
    page.evaluate('() => scrollTo(0, 0)')


def turn(page: Any, forcing: int, flashes: int) -> None:
    """Set shaft and lamp, and let the rod go."""
    for name, value in (('speed', forcing), ('dial', flashes)):
        page.get_by_test_id(name).fill(str(value))
        page.keyboard.press('Enter')
        page.keyboard.press('Escape')
    expect(page.get_by_test_id('dial-reading')).to_have_text(str(flashes), timeout=PATIENCE)
    time.sleep(3.0)  # the shaft gathers speed
    page.keyboard.press('r')
    time.sleep(1.0)


def lamp(page: Any) -> None:
    """Have the lamp in the middle of the screen."""
    bench(page)
    page.evaluate("() => document.getElementById('lamp').scrollIntoView({block: 'center'})")


def replay(page: Any) -> None:
    """Look at a place in the run."""
    expect(page.get_by_test_id('fit')).to_contain_text('95 % interval', timeout=PATIENCE)
    page.get_by_test_id('dial').fill(str(FLASHES))
    page.keyboard.press('Enter')
    page.get_by_test_id('place').fill('13')
    expect(page.get_by_test_id('status')).to_contain_text('13.0 of 15.5 s · 2240 RPM', timeout=PATIENCE)
    drawn(page)


def teacher(page: Any) -> None:
    """Wait for the table."""
    expect(page.get_by_test_id('coverage')).to_contain_text('handed in', timeout=PATIENCE)


def drawn(page: Any) -> None:
    """Wait until what the page knows is drawn."""
    frames = page.evaluate('() => Number(document.documentElement.dataset.frames || 0)')
    page.evaluate("async () => (await import(new URL('static/page.js', location))).redraw()")
    page.wait_for_function('frames => Number(document.documentElement.dataset.frames) > frames', arg=frames)


def main() -> None:
    """Take the pictures."""
    of_class = Path(sys.argv[1])
    with TemporaryDirectory() as folder, sync_playwright() as started:
        browser = started.chromium.launch(executable_path=shutil.which('chromium'), args=['--no-sandbox'])
        taken = {}
        with serving('bench', '--web', '--bags', Path(folder, 'runs'), '--table', Path(folder, 'mine.csv')) as [link]:
            taken['bench'] = montage(browser, link, bench)
            taken['lamp'] = montage(browser, link, lamp)
        with serving('replay', '--web', '--start-paused', HERE.parent / 'bags') as [link]:
            taken['replay'] = montage(browser, link, replay)
        with serving('serve', '--class', of_class / 'class.yaml', '--bags', of_class / 'class') as [_, link]:
            taken['class'] = montage(browser, link, teacher)
        browser.close()
    for name, picture in taken.items():
        HERE.joinpath(f'{name}.webp').write_bytes(picture)


if __name__ == '__main__':
    main()
