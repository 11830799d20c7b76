"""Parameters of a whole rig, besides those of its plant and its instruments."""

from __future__ import annotations

from dataclasses import dataclass

from kapitsa_ros.configuration.errors import ConfigurationError
from kapitsa_ros.schema import ParameterSet, quantity


@dataclass(frozen=True, kw_only=True)
class RigParameters(ParameterSet):
    """Chance and pace of a rig.

    Raises
    ------
    ConfigurationError
        A value is no finite number or out of its range.

    """

    error = ConfigurationError

    seed: int = quantity(1, '', 0, 2**63 - 1, description='of all chance in the rig')
    rate: float = quantity(0.0, '', 0.0, 1e4, description='simulated over wall seconds; 0: as fast as it can')
