"""Quantities as a caller gives them: a number in SI, a text with a unit, a quantity of a library of units; or many."""

from __future__ import annotations

from numbers import Real
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from kapitsa_ros.errors import QuantityError
from kapitsa_ros.units import is_quantity, magnitude, parse_quantity

if TYPE_CHECKING:
    from numpy.typing import NDArray

AnyQuantity: TypeAlias = Any
"""A number in SI, a text as in '2500 rpm', or a quantity of a library of units (which has `.to(unit).magnitude`)."""
AnyQuantities: TypeAlias = Any
"""An `AnyQuantity`, or an array or sequence of them."""

_EXAMPLES = {
    'rad/s': "234.6, '2240 rpm' or '37.3 Hz'",
    'm': "0.25, '9.75 in' or '250 mm'",
    'rad': "0.12 or '7 deg'",
    's': "60, '60 s' or '1 min'",
    'Hz': "1000 or '1000 Hz'",
}


def to_si(name: str, value: AnyQuantity, unit: str, bare: float = 1.0) -> float:
    """Return one quantity in an SI unit.

    Parameters
    ----------
    name
        What it is, for the message of an error.
    value
        The quantity.
    unit
        m, rad, s, Hz or rad/s.
    bare
        What a number without a unit is multiplied by.

    Raises
    ------
    QuantityError
        It is none, or of another dimension.

    """
    if is_quantity(value):
        value, bare = _magnitude(name, value, unit), 1.0
    try:
        if isinstance(value, str):
            return parse_quantity(value, unit, bare)
        if getattr(value, 'shape', None) == () and hasattr(value, 'item'):  # of numpy
            value = value.item()
        if isinstance(value, Real) and not isinstance(value, bool):
            return float(value) * bare
    except (ValueError, TypeError, OverflowError) as error:
        raise _error(name, value, unit) from error
    raise _error(name, value, unit)


def to_si_array(name: str, values: AnyQuantities, unit: str) -> NDArray[np.float64]:
    """Return quantities in an SI unit, in the shape they were given in; of a single one the shape is ().

    Raises
    ------
    QuantityError
        One is no quantity, or of another dimension.

    """
    given = _magnitude(name, values, unit) if is_quantity(values) else values
    try:
        array = np.asarray(given)
    except (ValueError, TypeError, OverflowError) as error:
        raise _error(name, values, unit) from error
    if array.dtype.kind in 'iuf':
        return array.astype(np.float64)
    if array.dtype.kind in 'UO':  # texts, or quantities one by one
        return np.array([to_si(name, value, unit) for value in array.astype(object).flat]).reshape(array.shape)
    raise _error(name, values, unit)


def _magnitude(name: str, value: Any, unit: str) -> Any:
    try:
        return magnitude(value, unit)
    except Exception as error:  # each library of units raises its own
        raise _error(name, value, unit) from error


def _error(name: str, value: Any, unit: str) -> QuantityError:
    return QuantityError(f'{name} is {value!r}: give a quantity in {unit}, as in {_EXAMPLES[unit]}')
