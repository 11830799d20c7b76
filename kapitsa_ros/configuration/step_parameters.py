"""How simulated time is divided between the nodes."""

from __future__ import annotations

from dataclasses import dataclass

from kapitsa_ros.configuration.errors import ConfigurationError
from kapitsa_ros.network.step_clock import SECOND
from kapitsa_ros.schema import ParameterSet, quantity


@dataclass(frozen=True, kw_only=True)
class StepParameters(ParameterSet):
    """Communication steps: they decide which step an answer falls into, and so the readings.

    Raises
    ------
    ConfigurationError
        A value is no finite number or out of its range.

    """

    error = ConfigurationError

    step: float = quantity(0.1, 's', 0.001, 1.0, description='length of a communication step')
    sample_rate: float = quantity(1000.0, 'Hz', 10.0, 1e5, description='samples of the motion a second')
    in_flight: int = quantity(4, '', 1, 100, description='steps under way at once; the same for operator and jigsaw')

    @property
    def step_ns(self) -> int:
        """Length of a step in whole nanoseconds."""
        return round(self.step * SECOND)

    @property
    def samples(self) -> int:
        """Sample intervals a step.

        Raises
        ------
        ConfigurationError
            They are not whole, or not of whole nanoseconds.

        """
        count = round(self.step * self.sample_rate)
        if abs(count - self.step * self.sample_rate) > 1e-9 or self.step_ns % max(count, 1):
            raise ConfigurationError(
                f'sample_rate: {self.sample_rate} Hz and a step of {self.step} s do not make whole samples of whole ns'
            )
        return count
