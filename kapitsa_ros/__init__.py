"""Kapitsa's inverted pendulum on a jigsaw: a plant, its instruments, their analysis and their ROS 2 graph.

`import kapitsa_ros as kr`; each name is loaded when it is first used, and ROS when a graph is started.

- A rod: `Plant`, `preset`.
- What theory says of it: `theory`, `stability_map`; what it does: `simulate`.
- The laboratory of 1997: `experiment` (as ROS 2 nodes), `campaign` (many, in process), `Rig` (in your hands).
- What was read: `read_bag`, `read_motion`, `verify`, `reduce`, `explain`, `plan`, `report`, `figures`.

Speeds, lengths, angles and times are numbers in SI, texts with a unit (`'2500 rpm'`, `'9.75 in'`) or quantities of a
library of units. A bare speed is in rad/s; `rpm(2500)` is 2500 RPM. Only `Rig.request_speed` takes RPM, as its dial
does. Errors that a user can correct are raised as a `KapitsaError`.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kapitsa_ros._api.campaign import campaign
    from kapitsa_ros._api.experiment import experiment
    from kapitsa_ros._api.explain import explain
    from kapitsa_ros._api.figures import figures
    from kapitsa_ros._api.plan import plan
    from kapitsa_ros._api.preset import preset
    from kapitsa_ros._api.read_bag import read_bag
    from kapitsa_ros._api.read_motion import read_motion
    from kapitsa_ros._api.reduce import reduce
    from kapitsa_ros._api.report import report
    from kapitsa_ros._api.rpm import rpm
    from kapitsa_ros._api.simulate import simulate
    from kapitsa_ros._api.stability_map import stability_map
    from kapitsa_ros._api.theory import theory
    from kapitsa_ros._api.verify import verify
    from kapitsa_ros.errors import KapitsaError
    from kapitsa_ros.physics.plant import Plant
    from kapitsa_ros.rig.harness import Rig

__all__ = [
    'KapitsaError',
    'Plant',
    'Rig',
    'campaign',
    'experiment',
    'explain',
    'figures',
    'plan',
    'preset',
    'read_bag',
    'read_motion',
    'reduce',
    'report',
    'rpm',
    'simulate',
    'stability_map',
    'theory',
    'verify',
]

__version__ = '0.1.0'

_CLASSES = {'KapitsaError': 'errors', 'Plant': 'physics.plant', 'Rig': 'rig.harness'}


if not TYPE_CHECKING:  # a checker would believe that there is everything

    def __getattr__(name: str) -> Any:
        if name not in __all__:
            raise AttributeError(f'module {__name__!r} has no attribute {name!r}')
        value = getattr(import_module(f'{__name__}.{_CLASSES.get(name, f"_api.{name}")}'), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return sorted([*__all__, '__version__', '__doc__'])
