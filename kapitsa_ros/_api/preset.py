"""`preset`: a plant by name."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kapitsa_ros.configuration.presets import load_preset

if TYPE_CHECKING:
    from pathlib import Path

    from kapitsa_ros.physics.plant import Plant


def preset(name: str | Path = 'ideal', **parameters: Any) -> Plant:
    """Return a plant that is shipped (`ideal`, `bearing`, `as_built_1997`), with some parameters replaced.

    Parameters
    ----------
    name
        Of a preset, or the path of a file.
    parameters
        Fields of `Plant`, in SI, with a unit, or as quantities.

    Raises
    ------
    KapitsaError
        There is no such preset, or a parameter is out of its range.

    Examples
    --------
    >>> import kapitsa_ros as kr
    >>> kr.preset('as_built_1997', length='9.75 in').inertia_factor
    0.7069

    """
    return load_preset(name, parameters)
