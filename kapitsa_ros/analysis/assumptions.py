"""What an analyst takes for granted about a rod and its instruments: stated, so that it can be disputed."""

from __future__ import annotations

from dataclasses import dataclass

from kapitsa_ros.analysis.errors import AnalysisError
from kapitsa_ros.schema import ParameterSet, quantity


@dataclass(frozen=True, kw_only=True)
class Assumptions(ParameterSet):
    """The priors of what the readings hardly show, and yet lean on.

    Play is either none or anything up to a limit; damping is light or anything up to a limit. Each alternative has a
    probability. A rectangular distribution is what the GUM (4.3.7) gives a quantity of which only limits are known.

    Raises
    ------
    AnalysisError
        A value is no finite number or out of its range.

    """

    error = AnalysisError

    play_probability: float = quantity(0.5, '', 0.0, 1.0, description='that the pivot has play')
    play_limit: float = quantity(2.5e-3, 'm', 0.0, 0.1, description='largest play, where there is any (rectangular)')
    light_damping: float = quantity(
        0.5, '1/s', 0.0, 10.0, above=True, description='scale of light viscous damping (half-normal)'
    )
    heavy_damping_probability: float = quantity(0.25, '', 0.0, 1.0, description='that damping is not light')
    heavy_damping_limit: float = quantity(
        6.0, '1/s', 0.0, 100.0, description='largest damping, where it is not light (rectangular)'
    )
    coulomb_probability: float = quantity(0.5, '', 0.0, 1.0, description='that there is Coulomb friction')
    coulomb_scale: float = quantity(
        1.0, 'rad/s²', 0.0, 100.0, above=True, description='scale of Coulomb friction, where there is any (half-Cauchy)'
    )
    miscount_probability: float = quantity(
        0.02, '', 0.0, 0.5, description='that the swings of a timing were counted one wrong'
    )
    stopwatch_rate_u: float = quantity(
        0.0, '', 0.0, 0.3, description="standard uncertainty of the stopwatch's rate (normal)"
    )
    dial_u: float = quantity(0.0, '', 0.0, 0.3, description="standard uncertainty of the dial's calibration (normal)")


DEFAULT_ASSUMPTIONS = Assumptions()
