"""What pages draw and say of a critical speed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from kapitsa_ros.units import RPM, decimals_within

if TYPE_CHECKING:
    from kapitsa_ros._api.reduce import Reduction


def fit_values(found: Reduction) -> dict[str, Any]:
    """Return readings and fit by name; RPM, an end of the interval that is None is unbounded."""
    readings = found.readings
    return {
        'omega_crit_rpm': found.omega_crit / RPM,
        'decimals': decimals_within(found.omega_crit_interval, RPM),
        'interval_rpm': [None if end is None else end / RPM for end in found.omega_crit_interval],
        'inverse_rpm': None if found.inverse_ols is None else found.inverse_ols / RPM,
        'slope': None if found.line is None else found.line.slope,
        'forcing_rpm': (readings.forcing / RPM).tolist(),
        'slow_rpm': (2.0 * np.pi / readings.period / RPM).tolist(),
        'warnings': list(found.warnings),
    }
