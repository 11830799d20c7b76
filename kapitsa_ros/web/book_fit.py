"""The critical speed by the person's own readings, worked out anew with each line of the book."""

from __future__ import annotations

import asyncio
import logging
from typing import TYPE_CHECKING, Any

from kapitsa_ros.errors import KapitsaError, said_of
from kapitsa_ros.message import Message, said_by
from kapitsa_ros.web.fit_values import fit_values

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from kapitsa_ros._api.reduce import Reduction
    from kapitsa_ros.physics.plant import Plant

_READINGS = 2
"""That a fit needs at least."""
_TOO_FEW = Message('two readings at different speeds make a line')
_AT_WORK = Message('the fit is being worked out')
_LOG = logging.getLogger(__name__)


class BookFit:
    """Keeps the reduction of a table: what `kapitsa reduce` says of it.

    Parameters
    ----------
    plant
        Its amplitude is the ruler's, and theory predicts for it.
    amplitude_sigma
        Standard uncertainty of that amplitude, m.
    on_change
        Called in the event loop whenever there is another fit.

    """

    def __init__(self, plant: Plant, amplitude_sigma: float, on_change: Callable[[], None]) -> None:
        self._plant, self._amplitude_sigma = plant, amplitude_sigma
        self._on_change = on_change
        self._values: dict[str, Any] = {}
        self._why = _TOO_FEW
        self._task: asyncio.Task[None] | None = None
        self._wanted: tuple[Path, int] | None = None

    def values(self, words: dict[str, str]) -> dict[str, Any]:
        """Return what is to be drawn and said; numbers are RPM and s."""
        if not self._values:
            return {'why': self._why.said_by(words)}
        warnings = [said_by(text, words) for text in self._values['warnings']]
        return {'why': None} | self._values | {'warnings': warnings}

    def begin(self, table: Path, readings: int) -> None:
        """Work the fit out anew, from a table with a number of readings; of several that wait the last."""
        self._wanted = table, readings
        if self._task is None or self._task.done():
            self._task = asyncio.get_running_loop().create_task(self._work_out())

    async def _work_out(self) -> None:
        while self._wanted is not None:
            (table, readings), self._wanted = self._wanted, None
            values: dict[str, Any] = {}
            why = _TOO_FEW
            if readings >= _READINGS:
                self._values, self._why = {}, _AT_WORK  # not the fit of a book that has changed
                self._on_change()
                try:
                    values = fit_values(await asyncio.to_thread(_reduced, table, self._plant, self._amplitude_sigma))
                except (KapitsaError, OSError) as error:
                    why = said_of(error)
                except Exception as error:  # noqa: BLE001  # a defect, of which the page would say nothing
                    _LOG.exception('the fit of %s failed', table)
                    why = Message('the fit failed: {why}', why=repr(error))
            self._values, self._why = values, why
            self._on_change()


def _reduced(table: Path, plant: Plant, amplitude_sigma: float) -> Reduction:
    # Half a second, for which the first picture need not wait.
    from kapitsa_ros._api.reduce import reduce  # noqa: PLC0415
    from kapitsa_ros.configuration.tables import read_timings  # noqa: PLC0415

    return reduce(read_timings(table), plant, amplitude_sigma=amplitude_sigma)
