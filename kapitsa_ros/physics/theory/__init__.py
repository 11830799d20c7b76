"""What theory says of the pendulum, from the averaged equation up to the nonlinear map.

SciPy's rooms are reached through `scipy` itself, which loads them at first use: a run need not wait for them.
"""

from kapitsa_ros.physics.theory.averaged import omega_crit_averaged, slow_frequency_averaged, slow_squared_averaged
from kapitsa_ros.physics.theory.comparison import TheoryResult, compare_theories
from kapitsa_ros.physics.theory.expansion import omega_crit_next_order, slow_frequency_next_order
from kapitsa_ros.physics.theory.floquet import (
    floquet_curves,
    growth_rate,
    is_stable,
    omega_crit_exact,
    omega_crit_upper,
    slow_frequency_exact,
)
from kapitsa_ros.physics.theory.friction import (
    amplitude_loss,
    buzz_angle,
    dither_ratio,
    dithered_factor,
    equivalent_damping,
    stuck_zone,
)
from kapitsa_ros.physics.theory.large_swings import slow_frequency_large, slow_start, slow_swing
from kapitsa_ros.physics.theory.mathieu import (
    boundary_perturbed,
    characteristic_a0,
    characteristic_a1,
    characteristic_b1,
    mathieu_a,
    mathieu_q,
)
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear
from kapitsa_ros.physics.theory.play import effective_amplitude, omega_crit_with_play, slow_frequency_with_play
from kapitsa_ros.physics.theory.sidebands import sidebands
from kapitsa_ros.physics.theory.stability import StabilityMap, stability_map

__all__ = [
    'StabilityMap',
    'TheoryResult',
    'amplitude_loss',
    'boundary_perturbed',
    'buzz_angle',
    'characteristic_a0',
    'characteristic_a1',
    'characteristic_b1',
    'compare_theories',
    'dither_ratio',
    'dithered_factor',
    'effective_amplitude',
    'equivalent_damping',
    'floquet_curves',
    'growth_rate',
    'is_stable',
    'mathieu_a',
    'mathieu_q',
    'omega_crit_averaged',
    'omega_crit_exact',
    'omega_crit_next_order',
    'omega_crit_upper',
    'omega_crit_with_play',
    'sidebands',
    'slow_frequency_averaged',
    'slow_frequency_exact',
    'slow_frequency_large',
    'slow_frequency_next_order',
    'slow_frequency_nonlinear',
    'slow_frequency_with_play',
    'slow_squared_averaged',
    'slow_start',
    'slow_swing',
    'stability_map',
    'stuck_zone',
]
