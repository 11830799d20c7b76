"""A student as a program, who works a bench of a class through its link, with eye and thumb of the stopwatch model."""

from __future__ import annotations

import asyncio
import json
import math
import struct
import time
from contextlib import suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from websockets.asyncio.client import connect
from websockets.exceptions import ConnectionClosed

from kapitsa_ros.instruments.persistence_filter import PersistenceFilter
from kapitsa_ros.instruments.press_errors import draw_press_errors

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings

HEADER = struct.Struct('<IIddI')
SWINGS = 3
SPIN_UP = 4.0
"""Seconds of the run that the shaft is given."""
PATIENCE = 15.0
"""Seconds of the run for which swings are waited for."""
LIES = 1.0
"""rad."""
RELEASES = (0.25, 0.4, 0.6)
"""rad; from farther out where friction ends the swing too soon."""


@dataclass
class Student:
    """One student before their bench.

    Parameters
    ----------
    address
        Of the link to the bench.
    length
        That was told, m.
    settings
        Of eye and thumb.
    rng
        Chance of the presses.

    """

    address: str
    settings: StopwatchSettings
    rng: np.random.Generator
    speeds: int
    told: dict[str, dict[str, Any]] = field(default_factory=dict)
    came: asyncio.Event = field(default_factory=asyncio.Event)
    """Set with each frame."""
    blocks: asyncio.Queue[tuple[float, float, NDArray[np.float64]]] = field(default_factory=asyncio.Queue)
    progress: list[tuple[float, float]] = field(default_factory=list)
    """Wall time and end of each step of the motion."""
    repaired: int = 0
    done: bool = False
    link: Any = None

    async def work(self) -> None:
        """Time swings at some speeds, and hand in what the page makes of them; after a lost link come back."""
        while not self.done:
            with suppress(ConnectionClosed, OSError):
                linked = connect(f'{self.address}&load=1', max_size=None, max_queue=None, compression=None)
                async with linked as self.link:
                    self.told.clear()
                    listening = asyncio.create_task(self._listen())
                    try:
                        working = asyncio.create_task(self._laboratory())
                        await asyncio.wait({listening, working}, return_when=asyncio.FIRST_COMPLETED)
                        if working.done():
                            working.result()
                    finally:
                        working.cancel()
                        listening.cancel()
            await asyncio.sleep(0.2)

    async def _listen(self) -> None:
        async for frame in self.link:
            self.came.set()
            if isinstance(frame, str):
                report = json.loads(frame)
                self.told[report['kind']] = report
                continue
            _, samples, start, period, _ = HEADER.unpack_from(frame)
            angle = np.frombuffer(frame, '<f4', samples, HEADER.size).astype(float)
            self.progress.append((time.monotonic(), start + period * (samples - 1)))
            self.blocks.put_nowait((start, period, angle))

    async def _ask(self, name: str, value: Any = None) -> None:
        await self.link.send(json.dumps({'do': name} if value is None else {'do': name, 'value': value}))

    async def _until(self, true: Any) -> None:
        while not true():
            self.came.clear()
            await self.came.wait()
        while not self.blocks.empty():  # nobody timed them
            self.blocks.get_nowait()

    async def _laboratory(self) -> None:
        await self._until(lambda: 'class' in self.told)
        if self.told['rig']['failure']:
            self.repaired += 1
            await self._ask('repair')
        await self._until(lambda: self.told['rig']['runs'])
        # A free rod of this length and the stroke of 1997 stands from here on; friction, play and inertia raise that.
        guess = 1400.0 * math.sqrt(self.told['class']['told_length'] / 0.25)
        speed = 1.5 * guess
        while len(self._lines()) < self.speeds:
            timed = await self._time_at(speed)
            speed = min(speed * (1.2 if timed else 1.1), 4800.0)
        await self._until(lambda: 'fit' in self.told)
        await self._until(lambda: len(self.told['fit'].get('forcing_rpm', ())) >= min(self.speeds, len(self._lines())))
        fit = self.told['fit']
        low, high = fit['interval_rpm']
        values = {'omega_crit_rpm': fit['omega_crit_rpm'], 'low_rpm': low or 1.0, 'high_rpm': high or 1e5}
        await self._ask('hand-in', values)
        await self._until(lambda: self.told['class']['handed_in'])
        self.done = True

    def _lines(self) -> list[Any]:
        return [line for line in self.told['book']['lines'] if 'note' not in line]

    async def _time_at(self, speed: float) -> bool:
        """Time swings at a speed and write them down; return whether there was anything to time."""
        written = len(self._lines())
        await self._ask('speed', round(speed))
        await self._ask('dial', 2.0 * round(speed))
        for angle in RELEASES:
            begin = self.progress[-1][1] if self.progress else 0.0
            await self._until(lambda begin=begin: self.progress and self.progress[-1][1] > begin + SPIN_UP)
            await self._ask('angle', angle)
            await self._ask('release')
            if await self._time_swings():
                await self._ask('write')
                await self._until(lambda: len(self._lines()) > written)
                return True
        return False

    async def _time_swings(self) -> bool:
        """Press the watch at passages through upright, as late as a thumb is."""
        errors = draw_press_errors(self.settings, self.rng)
        eye: PersistenceFilter | None = None
        before, passages, begin = math.nan, [], math.nan
        presses: list[float] = []
        while True:
            start, period, angle = await self.blocks.get()
            begin = start if math.isnan(begin) else begin
            if start - begin > PATIENCE or abs(angle[-1]) > LIES:
                await self._ask('clear')
                return False
            if start - begin < 1.0:  # it is caught and held
                continue
            if eye is None:
                eye, before = PersistenceFilter(self.settings.persistence, period, angle[0]), angle[0]
            seen = np.concatenate(([before], eye.see(angle[1:])))
            before = seen[-1]
            places = np.flatnonzero(np.signbit(seen[1:]) != np.signbit(seen[:-1]))
            passages += [start + (place + 1) * period - eye.latency for place in places.tolist()]
            # The first passage is let go by; the timing begins at the second.
            due = [passages[1] + errors.start_delay] if len(passages) > 1 else []
            last = 1 + 2 * (SWINGS + errors.miscount)
            due += [passages[last] + errors.stop_delay] if len(passages) > last else []
            for moment in due[len(presses) :]:
                if moment <= start + period * (angle.size - 1):
                    presses.append(moment)
                    await self._ask('watch', moment)
            if len(presses) == 2:
                return True
