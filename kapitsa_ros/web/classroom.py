"""A class: its benches, who joins them, and what the teacher sees of them."""

from __future__ import annotations

import asyncio
import secrets
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from kapitsa_ros.web.errors import PageRequestError
from kapitsa_ros.web.student_bench import StudentBench

if TYPE_CHECKING:
    from kapitsa_ros.configuration.class_settings import ClassSettings
    from kapitsa_ros.web.class_folder import ClassFolder

_STARTS = 2
"""Rigs that start at a time: more would only wait for each other."""
_LONGEST_NAME = 60


class Classroom:
    """All benches of a class; lives in the event loop.

    Parameters
    ----------
    settings
        Of the class.
    folder
        Of its files.

    """

    def __init__(self, settings: ClassSettings, folder: ClassFolder) -> None:
        self.settings = settings
        self.folder = folder
        starts = asyncio.Semaphore(_STARTS)
        self.benches = [
            StudentBench(number, bench, settings, starts) for number, bench in enumerate(folder.benches, start=1)
        ]
        self._telling = [asyncio.create_task(bench.tell_pages()) for bench in self.benches]

    def join(self, code: str, name: str) -> StudentBench:
        """Give a free bench to a student.

        Raises
        ------
        PageRequestError
            The code is not that of the class, the name is taken or none, or no bench is free.

        """
        if not _same(_plain(code), _plain(self.folder.join_code)):
            raise PageRequestError('that is not the code of this class')
        shown = ' '.join(''.join(sign for sign in name if sign.isprintable()).split())
        if not 1 <= len(shown) <= _LONGEST_NAME:
            raise PageRequestError('give a name of {most} characters at most', most=_LONGEST_NAME)
        if any(bench.record.name == shown for bench in self.benches):
            raise PageRequestError('that name is taken: go back by your own link, or ask the teacher for it')
        free = next((bench for bench in self.benches if bench.record.name is None), None)
        if free is None:
            raise PageRequestError('all {count} benches are taken', count=len(self.benches))
        try:
            free.assign(shown)
        except OSError as error:
            raise PageRequestError('the bench cannot be given away: {why}', why=error.strerror) from error
        return free

    def bench_of(self, key: str) -> StudentBench | None:
        """Return the bench that a student's link leads to; None where it leads to none."""
        found = [bench for bench in self.benches if _same(key, bench.record.key)]
        return found[0] if found and found[0].record.name is not None else None

    def is_teacher(self, token: str) -> bool:
        """Whether a link is the teacher's."""
        return _same(token, self.folder.token)

    async def rows(self) -> list[dict[str, Any]]:
        """Return how each bench stands and what was handed in there, against the truth; SI, speeds in RPM."""
        return [await self._row(bench) for bench in self.benches]

    async def end(self) -> None:
        """End all runs, so that their bags are complete, and stop the rigs."""
        await asyncio.gather(*(bench.end() for bench in self.benches))
        for task in self._telling:
            task.cancel()
            with suppress(asyncio.CancelledError):
                await task

    @staticmethod
    async def _row(bench: StudentBench) -> dict[str, Any]:
        last = bench.hand_ins[-1] if bench.hand_ins else None
        truth = await bench.truth() if last else None
        plant = bench.setup.plant
        return {
            'bench': bench.number,
            'name': bench.record.name,
            'joined': bench.record.joined,
            'state': _state(bench),
            'pages': len(list(bench.pages)),
            'run': bench.state.run,
            'speed_rpm': bench.state.speed,
            'readings': len(bench.state.notebook.rows),
            'handed_in': len(bench.hand_ins),
            'omega_crit_rpm': last and last.omega_crit_rpm,
            'low_rpm': last and last.low_rpm,
            'high_rpm': last and last.high_rpm,
            'width_rpm': last and last.high_rpm - last.low_rpm,
            'truth_rpm': truth,
            'covered': last and last.covers(truth),
            'when': last and last.when,
            'told_length_m': bench.record.told_length,
            'length_m': plant.length,
            'amplitude_m': plant.amplitude,
            'damping_per_s': plant.damping,
            'coulomb_rad_s2': plant.coulomb,
            'clearance_m': plant.clearance,
            'inertia_factor': plant.inertia_factor,
        }


def _state(bench: StudentBench) -> str:
    if bench.record.name is None:
        return 'free'
    if bench.failure is not None:
        return 'broken'
    if not bench.runs:
        return 'starting' if bench.is_starting else 'away'
    if bench.asleep:
        return 'asleep'
    if bench.state.paused:
        return 'paused'
    return 'at work' if list(bench.pages) else 'away'


def _plain(code: str) -> str:
    return ''.join(sign for sign in code.lower() if sign.isalnum())


def _same(given: str, wanted: str) -> bool:
    return secrets.compare_digest(given.encode(), wanted.encode())
