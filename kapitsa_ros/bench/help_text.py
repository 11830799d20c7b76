"""What the help screen says."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from kapitsa_ros.units import RPM

if TYPE_CHECKING:
    from kapitsa_ros.physics.plant import Plant

_HELP = """\
THE LABORATORY OF 1997, BY HAND

 1  Set the speed: ↑ ↓ by 10 RPM, PgUp PgDn by 100, s types it.
    The shaft takes a second or two to get there.
 2  Set the lamp: ← → by a touch, [ ] by 100, d types it (flashes a
    minute). Raise it until the mark stands still and is double: then
    the lamp flashes twice a turn. One image stands still at once a
    turn too, and at a half, a third … of it: do not be fooled.
 3  Say how many images you count: 1 to 5. The dial is divided by it.
 4  Let go: r catches the rod and releases it; a types the angle.
    Where friction stops the swing too soon, let go from farther out.
 5  Time some swings: space starts and stops the watch. Count them,
    + and - say how many they were. c clears the watch.
 6  w writes both down; u strikes the last line out. The table is on
    disk at once: `kapitsa reduce` takes it.
 7  x ends the run: its bag is closed, the next begins at rest.

 p  pause, resume    n  one step of a paused rig
 < >  half, twice the pace of time
 q, Ctrl-C  end the run and leave

Below {threshold:.0f} RPM an ideal rod cannot stand.         Any key goes back."""


def ideal_threshold(plant: Plant) -> float:
    """Return the critical speed of an ideal rod of a plant's length and stroke, RPM: (2/λ)√(gL/3) (report, eq. 8)."""
    # Not by `physics.theory`, which loads SciPy: a page would wait for it.
    return 2.0 / plant.amplitude * math.sqrt(plant.gravity * plant.length / 3.0) / RPM


def help_text(plant: Plant) -> str:
    """Return what is said at the bench of a plant."""
    return _HELP.format(threshold=ideal_threshold(plant))
