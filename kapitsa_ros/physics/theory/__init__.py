"""What theory says of the pendulum, from the averaged equation up to the nonlinear map."""

from kapitsa_ros.physics.theory.averaged import omega_crit_averaged, omega_crit_damped, slow_frequency_averaged
from kapitsa_ros.physics.theory.floquet import (
    growth_rate,
    is_stable,
    omega_crit_exact,
    omega_crit_upper,
    slow_frequency_exact,
)
from kapitsa_ros.physics.theory.mathieu import (
    boundary_perturbed,
    characteristic_a0,
    characteristic_a1,
    characteristic_b1,
    mathieu_a,
    mathieu_q,
)
from kapitsa_ros.physics.theory.nonlinear import slow_frequency_nonlinear

__all__ = [
    'boundary_perturbed',
    'characteristic_a0',
    'characteristic_a1',
    'characteristic_b1',
    'growth_rate',
    'is_stable',
    'mathieu_a',
    'mathieu_q',
    'omega_crit_averaged',
    'omega_crit_damped',
    'omega_crit_exact',
    'omega_crit_upper',
    'slow_frequency_averaged',
    'slow_frequency_exact',
    'slow_frequency_nonlinear',
]
