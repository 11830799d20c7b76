"""A recorded run once more through the graph, and what it comes to."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from kapitsa_ros.configuration.rig_parameters import RigParameters
from kapitsa_ros.laboratory.verification import compare_run
from kapitsa_ros.network.registry import REPLAYED, ROLE_NAMES, topic_named
from kapitsa_ros.recording.errors import BagError
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.rig.session import watch

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from kapitsa_ros.laboratory.verification import Verification
    from kapitsa_ros.network.step_id import StepId
    from kapitsa_ros.network.topic import Topic

_NO_PARAMETERS = {'node', 'versions', 'instrument', 'plant'}


def verify_through_graph(
    bag: RunBag, digest: str | None, on_progress: Callable[[dict[str, str]], None]
) -> Verification:
    """Let the nodes do a run again with its recorded commands, settings and seed, and compare what they record.

    Raises
    ------
    BagError
        The run cannot be read, or lies in a bag with others.
    RigError
        A node died.

    """
    bag.refuse_gaps()
    if bag.several or not bag.path.is_dir():
        raise BagError(
            f'{bag.path}: the graph repeats a run that has a folder of its own: `kapitsa bag recover --output`'
        )
    with TemporaryDirectory(prefix='kapitsa-') as folder:
        watch(ROLE_NAMES, _parameters(bag) | {'bags': folder}, on_progress)
        [path] = Path(folder).glob(f'run_{bag.number:02d}_*')
        again = RunBag(path)
        messages: dict[StepId, dict[Topic[Any], bytes]] = {}
        for step_id, topic, raw in again.messages_by_step(*(topic.name for topic in REPLAYED)):
            messages.setdefault(step_id, {})[topic_named(topic)] = raw
    return compare_run(bag, lambda step_id, _: messages.get(step_id, {}), digest)


def _parameters(bag: RunBag) -> dict[str, Any]:
    """Return the parameters of the nodes that recorded a run."""
    values: dict[str, Any] = {}
    settings: Mapping[str, Mapping[str, Any]] = bag.run.settings
    for role in settings.values():
        values |= {**role.get('plant', {}), **role.get('instrument', {})}
        values |= {name: value for name, value in role.items() if name not in _NO_PARAMETERS}
    rate = RigParameters(rate=0.0).rate
    return values | {'expect': list(ROLE_NAMES), 'protocol': str(bag.path.resolve()), 'rate': rate, 'storage': 'mcap'}
