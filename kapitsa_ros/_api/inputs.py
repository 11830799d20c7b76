"""Arguments of calls: a plant, instruments, a protocol or a table, given as an object, by name or by path."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from kapitsa_ros.analysis.assumptions import Assumptions
from kapitsa_ros.analysis.errors import TableError
from kapitsa_ros.analysis.table import PERIOD_SIGMA, Readings, refuse_mixed_units
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.configuration.tables import TimingTable, load_timings, table_of
from kapitsa_ros.instruments.settings import Instruments
from kapitsa_ros.operator.protocol import Protocol
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.quantities import to_si_array

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

AnyPlant: TypeAlias = 'Plant | str | Path | None'
AnyInstruments: TypeAlias = 'Instruments | str | Path'
AnyProtocol: TypeAlias = 'Protocol | str | Path'
AnyAssumptions: TypeAlias = 'Assumptions | Mapping[str, Any] | None'
AnyReadings: TypeAlias = 'TimingTable | Readings | str | Path | tuple[Any, ...]'


def as_plant(plant: AnyPlant) -> Plant:
    """Return a plant: itself, a preset by name or path, or for None the ideal rod of the report."""
    if plant is None:
        return Plant()
    return plant if isinstance(plant, Plant) else load_preset(plant)


def as_instruments(instruments: AnyInstruments) -> Instruments:
    """Return instruments: themselves, or a set by name or path."""
    return instruments if isinstance(instruments, Instruments) else load_instruments(instruments)


def as_protocol(protocol: AnyProtocol) -> Protocol:
    """Return a protocol: itself, or one by name or path."""
    return protocol if isinstance(protocol, Protocol) else load_protocol(protocol)


def as_assumptions(assumptions: AnyAssumptions) -> Assumptions:
    """Return assumptions: themselves, or the usual ones with some replaced."""
    return assumptions if isinstance(assumptions, Assumptions) else Assumptions.of(assumptions or {})


def as_readings(readings: AnyReadings) -> Readings:
    """Return speeds and periods: themselves, of a table by name or path, or of two to four columns.

    Raises
    ------
    TableError
        It is no table, or its values are none that runs can have.

    """
    return readings if isinstance(readings, Readings) else as_timings(readings).readings


def as_timings(readings: AnyReadings) -> TimingTable:
    """Return a table: itself, one by name or path, or one of readings or of two to four columns.

    The columns are speeds, periods, and the standard uncertainties of either, each an array or one value for all.

    Raises
    ------
    TableError
        It is no table, or its values are none that runs can have.

    """
    if isinstance(readings, TimingTable):
        return readings
    if isinstance(readings, Readings):
        return table_of(readings)
    if isinstance(readings, str | Path):
        return load_timings(readings)
    if not isinstance(readings, tuple) or not 2 <= len(readings) <= 4:
        raise TableError('readings: give a table by name or path, or the columns (speed, period), and their errors')
    forcing, period = to_si_array('speed', readings[0], 'rad/s'), to_si_array('period', readings[1], 's')
    errors: list[Any] = [*readings[2:], *(0.0, PERIOD_SIGMA)[len(readings) - 2 :]]
    typed = Readings(
        forcing=forcing,
        period=period,
        forcing_sigma=_column('speed_sigma', errors[0], 'rad/s', forcing),
        period_sigma=_column('period_sigma', errors[1], 's', forcing),
    )
    return table_of(refuse_mixed_units(typed))


def _column(name: str, values: Any, unit: str, like: NDArray[np.float64]) -> NDArray[np.float64]:
    column = to_si_array(name, values, unit)
    return np.full(like.shape, column) if column.ndim == 0 else column
