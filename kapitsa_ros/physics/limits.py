"""How far a computation may go: beyond, an answer would take for ever, or double precision has none."""

from __future__ import annotations

from kapitsa_ros.physics.errors import ParameterError

FASTEST = 1e6
"""rad/s; of the shaft, some ten million revolutions a minute."""
MOST_TURNS = 1e7
"""Of the shaft in one run: half a minute of computing."""
MOST_SAMPLES = 10**8
"""Of one motion: it fits into memory."""
LARGEST_Q = 1e4
"""Of Mathieu's q = 2kλ: a stroke some thousand times the rod's length."""


def check_forcing(speed: float) -> None:
    """Refuse a forcing speed, rad/s, of which nothing can be said.

    Raises
    ------
    ParameterError
        It is not above 0 and at most `FASTEST`.

    """
    if not 0.0 < speed <= FASTEST:
        raise ParameterError(f'speed is {speed:g} rad/s: give a finite speed above 0, at most {FASTEST:g} rad/s')
