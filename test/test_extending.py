"""The diffs of docs/extending.md do what it says."""

import json
import math
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from kapitsa_ros.analysis.slow_frequency import zero_crossing_frequency
from kapitsa_ros.network.registry import ROLE_NAMES
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.recording.reader import RunBag
from kapitsa_ros.rig import Rig
from kapitsa_ros.rig.environment import node_environment
from kapitsa_ros.units import RPM

PATIENCE = 180.0
ROOT = Path(__file__).parents[1]
SECTION = re.compile(r'^## (.+?)\n(.*?)(?=^## |\Z)', re.MULTILINE | re.DOTALL)
SECTIONS = dict(SECTION.findall((ROOT / 'docs' / 'extending.md').read_text(encoding='utf-8')))
DIFF = re.compile(r'^```diff\n(.*?)^```$', re.MULTILINE | re.DOTALL)

Python = Callable[..., str]
READ = """
import json, sys
from pathlib import Path
from kapitsa_ros.recording.reader import RunBag

run = RunBag(Path(sys.argv[1])).run
print(json.dumps([reading.speed for reading in run.readings['tachometer']]))
"""


@pytest.fixture
def extended(request: pytest.FixtureRequest, tmp_path: Path) -> Python:
    """Run Python in a copy of the checkout to which the diff of a section has been applied."""
    for name in ('kapitsa_ros', 'config'):
        shutil.copytree(ROOT / name, tmp_path / name)  # compiled kernels come along
    shutil.copy(ROOT / 'package.xml', tmp_path)
    (diff,) = DIFF.findall(SECTIONS[request.param])
    # A folder of temporary files may lie within some repository, whose root paths would be taken from.
    environment = {**os.environ, 'GIT_CEILING_DIRECTORIES': str(tmp_path.parent)}
    git = shutil.which('git')
    assert git is not None
    subprocess.run([git, 'apply', '-'], input=diff, text=True, check=True, cwd=tmp_path, env=environment)

    def run(*arguments: str, env: dict[str, str] | None = None) -> str:
        done = subprocess.run(
            [sys.executable, *arguments],
            cwd=tmp_path,
            env={**(env or os.environ), 'PYTHONPATH': str(tmp_path)},
            stdout=subprocess.PIPE,
            check=True,
            text=True,
            timeout=300,
        )
        return done.stdout

    return run


@pytest.mark.parametrize('extended', ['A recorded sensor'], indirect=True)
def test_a_sensor_is_recorded_analysed_and_replayed(extended: Python, tmp_path: Path) -> None:
    (tmp_path / 'short.yaml').write_text('speeds: [2500 rpm]\nrelease: 0.1 rad\nswings: 1\nrepeats: 1\n', 'utf-8')
    arguments = ['-m', 'kapitsa_ros', 'experiment', '--protocol', 'short.yaml', '--bags', 'runs', '--json']
    (run,) = json.loads(extended(*arguments))['runs']
    speeds = json.loads(extended('-c', READ, run['bag']))
    assert speeds[-1] == pytest.approx(2500 * 2 * math.pi / 60, rel=0.005)
    assert speeds[-1] != speeds[-2]  # it has a stream of random numbers
    (replayed,) = json.loads(extended('-m', 'kapitsa_ros', 'replay', run['bag'], '--json'))['runs']
    assert replayed == run


@pytest.mark.parametrize('extended', ['A recorded sensor'], indirect=True)
def test_bags_that_are_older_than_the_sensor_are_read_and_replayed(extended: Python) -> None:
    shipped = str(ROOT / 'bags' / 'run_01_2240rpm')
    assert json.loads(extended('-c', READ, shipped)) == []
    (analysed,) = json.loads(extended('-m', 'kapitsa_ros', 'analyse', shipped, '--json'))['runs']
    (replayed,) = json.loads(extended('-m', 'kapitsa_ros', 'replay', shipped, '--json'))['runs']
    assert replayed == analysed


@pytest.mark.parametrize('extended', ['An estimator of the slow frequency'], indirect=True)
def test_an_estimator_is_chosen_by_its_name(extended: Python) -> None:
    shipped = str(ROOT / 'bags' / 'run_01_2240rpm')
    arguments = ['-m', 'kapitsa_ros', 'analyse', shipped, '--motion', '--estimator', 'turning_points', '--json']
    (run,) = json.loads(extended(*arguments))['runs']
    # The zero crossings of the same motion give 0.984 s; that of turning points is known to a turn of the shaft.
    assert run['period_s'] == pytest.approx(0.984, abs=0.03)


@pytest.mark.parametrize('extended', ['A friction law'], indirect=True)
def test_static_friction_holds_the_rod_until_the_torque_exceeds_it(extended: Python) -> None:
    """Torque k (g − λω² cos ωt) sin θ rises from below f to above twice of it."""
    plant, speed, angle, f = Plant(), 40.0, 0.1, 8.0
    found = extended(
        '-c',
        'import json, os\n'
        "os.environ['NUMBA_DISABLE_JIT'] = '1'  # to compile all kernels for one turn of the shaft takes a minute\n"
        'import numpy as np\n'
        'from kapitsa_ros.cli.commands.simulate import simulate\n'
        'from kapitsa_ros.physics.plant import Plant\n'
        'from kapitsa_ros.physics.release import Release\n'
        'motions = []\n'
        'for ratio in (1.0, 1.5):\n'
        f'    plant = Plant(coulomb={f}, static_ratio=ratio)\n'
        f'    run = Release(plant=plant, speed={speed}, angle={angle}, phase=np.pi)\n'
        '    motions.append(run.sampled(0.08, 10_000.0).angle.tolist())\n'
        'print(json.dumps([motions, [option.name for option in simulate.params]]))\n',
    )
    motions, options = json.loads(found)
    assert 'static_ratio' in options
    for ratio, motion in zip((1.0, 1.5), motions, strict=True):
        cosine = (plant.gravity - ratio * f / (plant.k * math.sin(angle))) / (plant.amplitude * speed**2)
        moved = next(n for n, theta in enumerate(motion) if theta != angle)
        assert moved == math.ceil(math.acos(cosine) / speed * 10_000)
        later = moved + 20  # 2 ms: θ grows by half of (ratio − 1) f t², and the torque rises meanwhile
        if ratio > 1:
            assert motion[later] - angle > 0.5 * (ratio - 1) * f * 2e-3**2
        else:
            assert 0 < motion[later] - angle < 1e-5


@pytest.mark.parametrize('extended', ['A preset, an instrument set, a protocol, a table'], indirect=True)
def test_a_preset_is_found_by_its_name(extended: Python) -> None:
    theory = json.loads(extended('-m', 'kapitsa_ros', 'theory', '--preset', 'metre_rule', '--json'))
    rod = Plant(length=1.0, amplitude=0.02)
    assert theory['omega_crit_averaged_rpm'] == pytest.approx(
        math.sqrt(2 * rod.gravity / rod.k) / rod.amplitude / RPM, rel=1e-9
    )


@pytest.mark.parametrize('extended', ['A command'], indirect=True)
def test_a_command_is_found_by_its_name(extended: Python) -> None:
    period = json.loads(extended('-m', 'kapitsa_ros', 'period', '--speed', '2500', '--json'))['period_s']
    (speed,) = json.loads(extended('-m', 'kapitsa_ros', 'theory', '--speed', '2500', '--json'))['speeds']
    assert period == pytest.approx(60 / speed['slow_exact_rpm'])


@pytest.mark.parametrize('extended', ['A real rig'], indirect=True)
def test_a_driver_takes_the_place_of_a_node(extended: Python, tmp_path: Path) -> None:
    shipped = RunBag(ROOT / 'bags' / 'run_02_2640rpm')
    np.round(shipped.motion.angle / (2 * np.pi / 65_536)).astype('<i4').tofile(tmp_path / 'counts')
    (tmp_path / 'one.yaml').write_text('speeds: [2640]\n')
    with Rig(
        instruments='ideal', protocol=tmp_path / 'one.yaml', bags=tmp_path / 'runs',
        nodes=[role for role in ROLE_NAMES if role != 'pendulum'],
    ) as rig:  # fmt: skip
        extended('encoder.py', 'counts', env=node_environment(rig.domain))
        rig.wait_for('analyser/result', lambda result: 'experiment' in result, timeout=PATIENCE)
    (bag,) = map(RunBag, (tmp_path / 'runs').iterdir())
    assert bag.complete
    assert bag.run.plant == Plant(amplitude=shipped.run.plant.amplitude)
    slow = zero_crossing_frequency(shipped.recorded.living_swing())
    assert bag.run.period == pytest.approx(2 * math.pi / slow.value, rel=5e-3)
    assert np.abs(bag.motion.angle - shipped.motion.angle[: bag.motion.angle.size]).max() < 1e-4
