"""A recorded run once more: the recorded commands, settings and seed, without the graph."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any

from kapitsa_ros.configuration.step_parameters import StepParameters
from kapitsa_ros.errors import KapitsaError
from kapitsa_ros.instruments.random_streams import random_stream
from kapitsa_ros.instruments.stopwatch import Stopwatch
from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
from kapitsa_ros.instruments.strobe import Strobe
from kapitsa_ros.instruments.strobe_settings import StrobeSettings
from kapitsa_ros.network.cdr import aligned
from kapitsa_ros.network.registry import MOTION, PIVOT, STOPWATCH_READING, STROBE_READING
from kapitsa_ros.network.step_clock import StepClock
from kapitsa_ros.physics.jigsaw import Jigsaw
from kapitsa_ros.physics.jigsaw_parameters import JigsawParameters
from kapitsa_ros.physics.pendulum import Pendulum
from kapitsa_ros.recording.errors import BagError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from kapitsa_ros.network.run import Run
    from kapitsa_ros.network.step_id import StepId
    from kapitsa_ros.network.topic import Topic
    from kapitsa_ros.operator.command import Command

COMPUTED = (PIVOT, MOTION, STROBE_READING, STOPWATCH_READING)
"""Topics whose messages follow from the commands."""
_BESIDES = {
    'jigsaw': {'node', 'amplitude', 'versions'},
    'pendulum': {'node', 'plant'},
    'strobe': {'node', 'seed', 'instrument'},
    'stopwatch': {'node', 'seed', 'swings', 'instrument'},
}
"""What the settings of a role hold besides a parameter set."""


class RecomputedRun:
    """Does what jigsaw, pendulum, strobe and stopwatch did in a run, step by step.

    Parameters
    ----------
    run
        The recorded one.

    Raises
    ------
    BagError
        Its settings are not those of this version.

    """

    def __init__(self, run: Run) -> None:
        settings = run.settings
        try:
            parameters = _set_of(StepParameters, settings['jigsaw'])
            self._steps, self._samples = StepClock(parameters.step_ns), parameters.samples
            self._jigsaw = Jigsaw(
                amplitude=run.plant.amplitude, parameters=_set_of(JigsawParameters, settings['jigsaw'])
            )
            self._pendulum = Pendulum(run.plant)
            strobe, watch = settings['strobe'], settings['stopwatch']
            self._strobe = Strobe(
                StrobeSettings.of(strobe['instrument']), random_stream(strobe['seed'], 'strobe', run.number)
            )
            self._watch = Stopwatch(
                StopwatchSettings.of(watch['instrument']),
                watch['swings'],
                random_stream(watch['seed'], 'stopwatch', run.number),
            )
        except (KapitsaError, KeyError, TypeError, ValueError) as error:
            raise BagError(f'the settings of run {run.number} are not those of this version: {error}') from error
        _refuse_unknown(settings)

    def step(self, step_id: StepId, command: Command) -> dict[Topic[Any], bytes]:
        """Return the messages that a command leads to, as the graph carries them."""
        stamp, start = self._steps.start_ns(step_id), self._steps.start(step_id)
        messages: dict[Topic[Any], bytes] = {}

        def carried(topic: Topic[Any], value: Any) -> Any:
            """Return a value as its reader gets it."""
            messages[topic] = padded(topic.encode(stamp, step_id, value))
            return topic.decode(messages[topic])

        pivot = carried(PIVOT, self._jigsaw.advance(command.speed, self._steps.step, self._samples))
        if command.hold is None:
            self._pendulum.release()
        else:
            self._pendulum.hold(command.hold)
        motion = carried(MOTION, self._pendulum.advance(pivot))
        carried(STROBE_READING, self._strobe.observe(start, pivot))
        carried(STOPWATCH_READING, self._watch.observe(start, motion))
        return messages

    def end(self, step_id: StepId) -> dict[Topic[Any], bytes]:
        """Return the messages that say that the run is over."""
        stamp = self._steps.start_ns(step_id)
        return {topic: padded(topic.codec.encode_silence(stamp, step_id)) for topic in COMPUTED}


def padded(raw: bytes) -> bytes:
    """Return a message as it arrives: on its way it is padded to whole words."""
    return raw + bytes(aligned(len(raw), 4))


def _set_of(kind: Any, settings: Mapping[str, Any]) -> Any:
    """Return a parameter set; what a bag is too old to state has its default."""
    names = {item.name for item in fields(kind)}
    return kind.of({name: value for name, value in settings.items() if name in names})


def _refuse_unknown(settings: Mapping[str, Mapping[str, Any]]) -> None:
    known = {name: set(besides) for name, besides in _BESIDES.items()}
    known['jigsaw'] |= {item.name for kind in (StepParameters, JigsawParameters) for item in fields(kind)}
    for role, names in known.items():
        if unknown := sorted(set(settings[role]) - names):
            raise BagError(f'the settings of {role} hold {", ".join(unknown)}, which this version does not know')
