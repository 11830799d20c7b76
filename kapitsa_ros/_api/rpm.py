"""`rpm`: speeds as a dial shows them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, overload

from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray


@overload
def rpm(speed: float) -> float: ...
@overload
def rpm(speed: ArrayLike) -> NDArray[np.float64]: ...
def rpm(speed: Any) -> Any:
    """Turn revolutions a minute into rad/s, which is what a bare speed means here.

    Parameters
    ----------
    speed
        RPM, a number or an array.

    Returns
    -------
    float or numpy.ndarray
        rad/s, of the same shape.

    Examples
    --------
    >>> import kapitsa_ros as kr
    >>> round(kr.rpm(2500), 3)
    261.799

    """
    if isinstance(speed, int | float):
        return speed * RPM
    import numpy as np  # noqa: PLC0415  # a number does without

    return np.asarray(speed, dtype=np.float64) * RPM
