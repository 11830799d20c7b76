"""A class of scripted students with clumsy thumbs: what it costs, who falls behind, and how honest their intervals are.

Each student times swings at some speeds through the link that the page has, and hands in the fit of the page. Prints
the cores that server and rigs take while all are at work, their memory, how far the slowest rig lags behind the clock,
and how many of the intervals hold the threshold of the sealed rod. With --kills the server is killed that many times
in mid-run and started again; then what it has to keep is counted, too.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import os
import signal
import socket
import subprocess
import sys
import time
import urllib.request
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import uvloop
from measure import cpu_of, memory_of
from scripted_student import Student

from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.naming import run_folders
from kapitsa_ros.recording.reader import RunBag


class Server:
    """A `kapitsa serve` that can be killed and started again."""

    def __init__(self, folder: Path, students: int, seed: int, rate: float) -> None:
        self.folder = folder / 'class'
        self._file = folder / 'class.yaml'
        self._file.write_text(f'benches: {students}\nseed: {seed}\nrate: {rate}\n', encoding='utf-8')
        with socket.create_server(('127.0.0.1', 0)) as free:
            self.port = free.getsockname()[1]
        self.process: subprocess.Popen[str]
        self.url: str
        self.token: str
        self.start()

    def start(self) -> None:
        """Start it, and read its links."""
        command = [sys.executable, '-m', 'kapitsa_ros', 'serve', '--class', str(self._file), '--no-open']
        command += ['--bags', str(self.folder), '--port', str(self.port)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)  # noqa: S603
        lines = self.process.stdout or iter(())
        self.url = next(lines).split()[1]
        self.token = next(lines).partition('token=')[2].strip()

    def join(self, name: str) -> str:
        """Join the class; return the address of the link to the bench."""
        code = self.url.partition('join=')[2]
        body = json.dumps({'code': code, 'name': name}).encode()
        with urllib.request.urlopen(f'http://127.0.0.1:{self.port}/join', body) as answer:
            key = json.load(answer)['link'].partition('=')[2]
        return f'ws://127.0.0.1:{self.port}/bench?key=page&bench={key}'

    def teacher(self) -> dict[str, Any]:
        """Return what the teacher's page is told."""
        with urllib.request.urlopen(f'http://127.0.0.1:{self.port}/teacher.json?token={self.token}') as answer:
            told: dict[str, Any] = json.load(answer)
        return told


def tree(pid: int) -> list[int]:
    """Return a process and all that it has started."""
    found = [pid]
    for task in Path(f'/proc/{pid}/task').iterdir():
        for child in (task / 'children').read_text().split():
            found += tree(int(child))
    return found


async def measure(server: Server, students: list[Student], seconds: float, rate: float) -> dict[str, float]:
    """Measure for a while in which all are at work."""
    pids = tree(server.process.pid)
    before, since = {pid: cpu_of(pid) for pid in pids}, time.monotonic()
    begun = [student.progress[-1] for student in students]
    await asyncio.sleep(seconds)
    wall = time.monotonic() - since
    used = {pid: cpu_of(pid) - before[pid] for pid in pids}
    lags = []
    for student, (from_wall, from_end) in zip(students, begun, strict=True):
        to_wall, to_end = student.progress[-1]
        lags.append(1.0 - (to_end - from_end) / (rate * (to_wall - from_wall)) if to_wall > from_wall else 1.0)
    own = used.pop(server.process.pid)
    return {
        'server_cores': own / wall,
        'rigs_cores': sum(used.values()) / wall,
        'memory_mb': sum(map(memory_of, tree(server.process.pid))),
        'processes': float(len(pids)),
        'behind': float(sum(lag > 0.02 for lag in lags)),
        'slowest_share_of_pace': 1.0 - max(lags),
    }


async def class_at_work(server: Server, arguments: argparse.Namespace) -> dict[str, Any]:
    """Let a class work to its end; return what it cost and came to."""
    settings = load_instruments('1997').stopwatch
    students = [
        Student(
            server.join(f'student {number}'),
            settings,
            np.random.default_rng([arguments.seed, number]),
            arguments.speeds,
        )
        for number in range(arguments.students)
    ]
    began = time.monotonic()
    working = [asyncio.create_task(student.work()) for student in students]
    while not all(student.told.get('rig', {}).get('runs') and len(student.progress) > 20 for student in students):
        await asyncio.sleep(0.1)
        for broken in (task for task in working if task.done()):
            broken.result()
    started = time.monotonic() - began
    found = await measure(server, students, arguments.window, arguments.rate)
    for _ in range(arguments.kills):
        server.process.send_signal(signal.SIGKILL)
        server.process.wait()
        server.start()
        await asyncio.sleep(10.0 / arguments.rate)
    done, _ = await asyncio.wait(working, timeout=arguments.patience)
    for task in done:
        task.result()
    told = server.teacher()
    notes = sum(path.read_text().count('was cut off') for path in server.folder.glob('bench_*/book.csv'))
    return {
        'students': arguments.students,
        'all_started_s': started,
        **found,
        'finished': sum(student.done for student in students),
        'repaired': sum(student.repaired for student in students),
        'runs_marked_as_cut': notes,
        **told['coverage'],
    }


def count_bags(folder: Path) -> dict[str, int]:
    """Return how many runs there are, and how many of them are damaged or unreadable."""
    counted = {'runs': 0, 'cut_runs': 0, 'damaged_runs': 0}
    for path in run_folders(sorted(folder.glob('bench_*/runs')) + sorted(folder.glob('bench_*/runs/rig_*'))):
        if not path.name.startswith('run_'):
            continue
        counted['runs'] += 1
        try:
            bag = RunBag(path)
            counted['cut_runs'] += not bag.complete
            counted['damaged_runs'] += bool(bag.motion.gaps or bag.integrity.ok is False)
        except BagError:
            counted['damaged_runs'] += 1
    return counted


def main() -> None:
    """Print what was found, as one JSON object."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--students', type=int, default=3)
    parser.add_argument('--speeds', type=int, default=3, help='at which each times, two at least')
    parser.add_argument('--rate', type=float, default=1.0)
    parser.add_argument('--kills', type=int, default=0)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--window', type=float, default=15.0, help='seconds for which is measured')
    parser.add_argument('--patience', type=float, default=300.0, help='seconds')
    parser.add_argument('--keep', type=Path, help='folder in which class.yaml and class/ are left, for kapitsa serve')
    arguments = parser.parse_args()
    if arguments.speeds < 2:
        parser.error('--speeds: the fit that students hand in takes two at least')
    load = os.getloadavg()[0]
    with ExitStack() as stack:
        folder = arguments.keep or Path(stack.enter_context(TemporaryDirectory()))
        folder.mkdir(parents=True, exist_ok=True)
        server = Server(folder, arguments.students, arguments.seed, arguments.rate)
        try:
            found = uvloop.run(class_at_work(server, arguments))
            server.process.send_signal(signal.SIGINT)
            server.process.communicate(timeout=60)
        finally:
            server.process.kill()
            server.process.wait()
        print(json.dumps(found | count_bags(server.folder) | {'load_before': load}))


if __name__ == '__main__':
    main()
