"""A rig's setup, and the parameters of its nodes that follow from it; for launch files, harness and command line."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.playback_parameters import PlaybackParameters
from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.configuration.rig_parameters import RigParameters
from kapitsa_ros.configuration.step_parameters import StepParameters
from kapitsa_ros.network.registry import REPLAY_NAMES, ROLE_NAMES
from kapitsa_ros.operator.protocol import MANUAL, Protocol
from kapitsa_ros.physics.plant import Plant

if TYPE_CHECKING:
    from collections.abc import Sequence

    from kapitsa_ros.instruments.settings import Instruments


@dataclass(frozen=True, kw_only=True)
class Setup:
    """What a rig is made of; every parameter of a node follows from it."""

    plant: Plant = field(default_factory=Plant)
    instruments: Instruments = field(default_factory=partial(load_instruments, '1997'))
    protocol: str = '1997'
    seed: int = 1
    rate: float = 0.0
    steps: StepParameters = field(default_factory=StepParameters)
    bags: Path = Path('runs')
    storage: str = 'mcap'
    compression: str = 'zstd'
    roles: tuple[str, ...] = ROLE_NAMES
    composed: bool = False
    """Whether the nodes share one process."""

    def carried_out(self) -> Protocol:
        """Return the protocol."""
        return load_protocol(self.protocol)


def parameters(setup: Setup) -> dict[str, Any]:
    """Return the parameters that every node of a rig is given; each takes those it declares."""
    return {
        **asdict(setup.plant),
        **asdict(setup.instruments.strobe),
        **asdict(setup.instruments.stopwatch),
        'expect': list(setup.roles),
        'protocol': setup.protocol,
        **({} if setup.protocol == MANUAL else {'swings': setup.carried_out().swings}),
        **asdict(RigParameters(seed=setup.seed, rate=setup.rate)),
        **asdict(setup.steps),
        'bags': str(setup.bags),
        'storage': setup.storage,
        'compression': setup.compression,
    }


@dataclass(frozen=True, kw_only=True)
class Replay:
    """How recorded runs are played."""

    rate: float = 0.0
    part: PlaybackParameters = field(default_factory=PlaybackParameters)
    composed: bool = False
    """Whether the nodes share one process."""
    loop: bool = False
    """Whether to begin again at the end, until the player is told to leave."""
    start_paused: bool = False


def replay_parameters(bags: Sequence[Path], replay: Replay) -> dict[str, Any]:
    """Return the parameters of player and analyser."""
    return {
        'expect': list(REPLAY_NAMES),
        'bags': [str(bag) for bag in bags],
        'rate': RigParameters(rate=replay.rate).rate,
        'loop': replay.loop,
        'start_paused': replay.start_paused,
        **asdict(replay.part),
    }
