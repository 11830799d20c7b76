"""Plants and instruments of one's own in a rig: on the command line, by launch, in Python."""

from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.instruments.settings import Instruments
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.rig import Rig
from kapitsa_ros.rig.launch_arguments import rig_from
from kapitsa_ros.rig.setup import parameters

PATIENCE = 180.0

pytestmark = pytest.mark.xdist_group('harness')


def recorded(run: RunBag) -> Instruments:
    """Return the instruments that the nodes of a run say they are."""
    settings = run.run.settings
    return Instruments.of({**settings['strobe']['instrument'], **settings['stopwatch']['instrument']})


def end_first_run(rig: Rig) -> None:
    """The second run moves only when the first has been recorded."""
    rig.reset()
    rig.wait_for('pendulum/motion', timeout=PATIENCE)


def first_run(bags: Path) -> RunBag:
    (path,) = bags.glob('run_01_*')
    return RunBag(path)


def test_a_plant_of_ints_numpys_scalars_and_texts_starts(tmp_path: Path) -> None:
    """D3. What the instruments come from is a file."""
    plant = Plant(damping=1, length='9.75in', gravity=np.float64(9.81), coulomb=np.int32(1))
    path = tmp_path / 'mine.yaml'
    path.write_text('/**:\n  ros__parameters:\n    reaction_time: 0.3\n')
    with Rig(plant, instruments=path, seed=np.int64(3), rate=np.float32(0), bags=tmp_path) as rig:
        end_first_run(rig)
    run = first_run(tmp_path)
    assert run.run.plant == plant
    assert run.run.settings['strobe']['seed'] == 3
    assert recorded(run).stopwatch.reaction_time == 0.3


def test_instruments_in_python(tmp_path: Path) -> None:
    mine = load_instruments('ideal', {'reaction_time': '200 ms', 'dial_error': 0.01})
    with Rig(instruments=mine, bags=tmp_path) as rig:
        end_first_run(rig)
    found = recorded(first_run(tmp_path))
    assert found == mine
    assert found.stopwatch.reaction_time == 0.2


def test_by_launch(tmp_path: Path) -> None:
    arguments = {
        'preset': 'bearing', 'plant': 'length=10in coulomb=0.3', 'instruments': 'ideal', 'protocol': '1997',
        'instrument': 'reaction_time=200ms dial_error=0.01', 'rate': '0', 'seed': '1', 'bags': str(tmp_path / 'A'),
        'compression': 'zstd',
    }  # fmt: skip
    setup = rig_from(arguments)
    assert setup.plant == Plant(length=0.254, damping=0.1, coulomb=0.3)
    assert parameters(setup).items() >= {'reaction_time': 0.2, 'dial_error': 0.01, 'length': 0.254}.items()


def test_on_the_command_line(kapitsa: Any, tmp_path: Path) -> None:
    (tmp_path / 'one.yaml').write_text('speeds: [2500]\nswings: 1\n')
    answer = kapitsa(
        'experiment', '--instruments', 'ideal', '--instrument', 'reaction_time=0.2', '--instrument', 'dial_error=0.01',
        '--protocol', tmp_path / 'one.yaml', '--bags', tmp_path, '--json',
    )  # fmt: skip
    assert answer.status == 0, answer.err
    found = recorded(first_run(tmp_path))
    ideal = load_instruments('ideal')
    assert asdict(found.strobe) == asdict(replace(ideal.strobe, dial_error=0.01))
    assert asdict(found.stopwatch) == asdict(replace(ideal.stopwatch, reaction_time=0.2))
