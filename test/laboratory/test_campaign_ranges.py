"""What a campaign varies, and that its file holds the same outcomes whatever has interrupted it."""

import os
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

import kapitsa_ros as kr
from kapitsa_ros._api.campaign_report import campaign_report
from kapitsa_ros.configuration.campaign_ranges import ONE_POINT, load_ranges
from kapitsa_ros.configuration.errors import ConfigurationError
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.errors import OutputError
from kapitsa_ros.laboratory import campaign_file, campaign_points
from kapitsa_ros.laboratory.campaign import Outcome
from kapitsa_ros.laboratory.campaign_file import CampaignFile, read_campaign
from kapitsa_ros.laboratory.errors import DiskError
from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.units import RPM

pa = pytest.importorskip('pyarrow')
from pyarrow import parquet  # noqa: E402

PATIENCE = 120.0
EACH = 10  # at two points: one part is written before the end


def written(folder: Path, **values: Any) -> Path:
    path = folder / 'ranges.yaml'
    path.write_text(yaml.safe_dump(values, sort_keys=False), encoding='utf-8')
    return path


def test_a_grid_has_every_combination_and_units_become_si(tmp_path: Path) -> None:
    factors = {'preset': ['ideal', 'bearing'], 'clearance': {'from': '0 mm', 'to': '2 mm', 'count': 3}}
    found = load_ranges(written(tmp_path, factors=factors, experiments=5))
    assert found.factors == ('preset', 'clearance')
    assert found.experiments == 5
    assert found.points == tuple((preset, size) for preset in ('ideal', 'bearing') for size in (0.0, 1e-3, 2e-3))


def test_a_list_goes_through_all_factors_at_once(tmp_path: Path) -> None:
    factors = {'coulomb': [0, 3.0], 'reaction_jitter': ['30 ms', 0.07]}
    found = load_ranges(written(tmp_path, design='list', factors=factors))
    assert found.points == ((0.0, 0.03), (3.0, 0.07))
    assert found.experiments is None


def test_a_latin_hypercube_has_one_value_in_each_stratum_and_follows_its_seed(tmp_path: Path) -> None:
    factors = {'damping': {'from': 1.0, 'to': 5.0}, 'preset': ['ideal', 'bearing']}

    def points(seed: int) -> tuple[tuple[str | float, ...], ...]:
        path = written(tmp_path, design='latin_hypercube', factors=factors, points=8, seed=seed)
        return load_ranges(path).points

    damping = np.array([float(point[0]) for point in points(1)])
    assert sorted(np.floor((damping - 1.0) / 0.5).astype(int)) == list(range(8))
    assert sorted(str(point[1]) for point in points(1)) == ['bearing'] * 4 + ['ideal'] * 4
    assert points(1) == points(1) != points(2)


@pytest.mark.parametrize(
    ('values', 'message'),
    [
        ({}, 'no factors'),
        ({'factors': {'coulomb': []}}, 'coulomb: empty'),
        ({'factors': {'coulomb': {'from': 3, 'to': 3, 'count': 2}}}, 'coulomb: empty, from 3 to 3'),
        ({'factors': {'coulomb': {'from': 0, 'to': 3}}}, 'give the count'),
        ({'factors': {'coulomb': [-1]}}, 'coulomb is -1'),
        ({'factors': {'colour': ['red']}}, 'no factor colour'),
        ({'factors': {'coulomb': [1]}, 'desing': 'grid'}, 'no key desing'),
        ({'factors': {'coulomb': [1]}, 'design': 'random'}, "design is 'random'"),
        ({'factors': {'coulomb': [1], 'damping': [1, 2]}, 'design': 'list'}, '1 of coulomb, 2 of damping'),
        ({'factors': {'coulomb': [1]}, 'design': 'latin_hypercube'}, 'takes the number of points'),
        ({'factors': {'coulomb': [1]}, 'points': 3}, 'not of grid'),
        ({'factors': {'coulomb': [1]}, 'experiments': 0}, 'experiments is 0'),
        (
            {'factors': {name: {'from': 0, 'to': 1, 'count': 400} for name in ('coulomb', 'damping')}},
            '160000 points: at most 100000',
        ),
        (
            {'factors': {'coulomb': {'from': 0, 'to': 3, 'count': 3_000_000_000}}},
            'coulomb: count is 3000000000: give a whole number from 2 to 100000',
        ),
        (
            {'factors': {'coulomb': [1]}, 'design': 'latin_hypercube', 'points': 10**12},
            'points is 1000000000000: give a whole number from 1 to 100000',
        ),
        ({'factors': {'coulomb': [1]}, 'experiments': 10**20}, 'give a whole number from 1 to 10000000'),
    ],
)
def test_ranges_that_cannot_be_are_refused(tmp_path: Path, values: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigurationError, match=message):
        load_ranges(written(tmp_path, **values))


@pytest.mark.parametrize(
    'line', ['factors: {coulomb: [NUMBER]}', 'experiments: NUMBER', 'experiments: -NUMBER', 'seed: NUMBER']
)
def test_a_number_that_nothing_can_take_is_told_with_its_line(tmp_path: Path, line: str) -> None:
    path = tmp_path / 'ranges.yaml'
    for number in ('9' * 5000, f'0x{"f" * 5000}'):
        path.write_text(f'design: grid\n{line}\n'.replace('NUMBER', number))
        with pytest.raises(ConfigurationError, match='not YAML: a whole number in line 2 has more than 300 digits'):
            load_ranges(path)


def test_more_experiments_than_a_campaign_can_have_are_refused(tmp_path: Path) -> None:
    path = written(tmp_path, factors={'coulomb': [0, 1]}, experiments=6_000_000)
    for asked in ({'ranges': path}, {'experiments': 10**30}):
        with pytest.raises(ConfigurationError, match=r'experiments at each of [12] points: at most 10000000'):
            kr.campaign(**asked)


def test_a_point_that_is_no_plant_is_named_before_the_work(tmp_path: Path) -> None:
    path = written(tmp_path, factors={'coulomb': [1], 'clearance': ['1 mm', '20 mm']}, experiments=1)
    with pytest.raises(ConfigurationError, match=r'coulomb = 1, clearance = 0\.02: clearance is 0\.02 m'):
        kr.campaign(ranges=path)


def test_each_point_is_judged_by_its_own_truth(tmp_path: Path) -> None:
    """Outcomes are those of the same experiments by themselves."""
    path = written(tmp_path, factors={'preset': ['ideal', 'as_built_1997']}, experiments=2)
    found = kr.campaign(ranges=path)
    assert [point.truth / RPM for point in found.points] == pytest.approx([1354.80, 1594.92], abs=0.01)
    assert found.seed.tolist() == [1, 2, 3, 4]  # no chance is shared between points
    first = kr.campaign('ideal', experiments=2).omega_crit
    second = kr.campaign('as_built_1997', experiments=4).omega_crit[2:]
    assert found.omega_crit == pytest.approx(np.concatenate((first, second)))
    assert [each.coverage for each in found.at_points] == [1.0, 1.0]
    assert found.summary.coverage == 1.0
    assert found.failure == (None,) * 4
    assert list(found.to_pandas()['preset']) == ['ideal', 'ideal', 'as_built_1997', 'as_built_1997']


def test_what_a_factor_replaces_is_not_taken_in_silence(tmp_path: Path, kapitsa: Callable[..., Any]) -> None:
    path = written(tmp_path, factors={'preset': ['ideal', 'bearing'], 'dial_error': [0.0]}, experiments=1)
    for options, option in (
        (('--coulomb', '5'), '--coulomb'),
        (('--preset', 'bearing'), '--preset'),
        (('--instrument', 'dial_error=0.1'), '--dial-error'),
    ):
        answer = kapitsa('campaign', '--ranges', path, *options)
        assert answer.status == 2
        assert f'{option} has no effect beside the factor' in answer.err
    assert kapitsa('campaign', '--ranges', path, '--protocol', '1997', '--json').json['experiments'] == 2


def test_a_value_that_would_count_twice_is_refused_and_one_by_itself_taken(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match='coulomb: a value is there twice'):
        load_ranges(written(tmp_path, factors={'coulomb': [0, 1, '0 rad/s^2']}))
    assert load_ranges(written(tmp_path, factors={'coulomb': 3, 'preset': 'ideal'})).points == ((3.0, 'ideal'),)
    with pytest.raises(ConfigurationError, match='coulomb: count is 1'):
        load_ranges(written(tmp_path, factors={'coulomb': {'from': 0, 'to': 3, 'count': 1}}))


def test_experiments_without_a_result_are_told_with_their_seeds(short: Path, kapitsa: Callable[..., Any]) -> None:
    hot = short.with_name('hot.yaml')
    hot.write_text(yaml.safe_dump({'factors': {'damping': [0.0, 1e6]}, 'experiments': 7}))
    protocol = ('--protocol', short.with_name('one.yaml'))
    lines = kapitsa('campaign', '--ranges', hot, *protocol).out
    assert '7 without a critical speed: ' in lines
    assert '(point 2, seeds 8, 9, 10, 11, 12 and 2 more)' in lines
    failures = kapitsa('campaign', '--ranges', hot, *protocol, '--json').json['failures']
    assert [(each['point'], each['seed']) for each in failures] == [(2, seed) for seed in range(8, 15)]
    alone = kapitsa('campaign', '--experiments', '3', '--damping', '1e6', *protocol).out
    assert failures[0]['reason'] in ' '.join(alone.split())
    assert 'higher speeds' not in alone


def test_a_process_that_is_killed_ends_the_campaign_with_a_line(short: Path, tmp_path: Path) -> None:
    output = tmp_path / 'cut.parquet'
    command = [sys.executable, '-m', 'kapitsa_ros', 'campaign', '--ranges', str(short), '--output', str(output)]
    with subprocess.Popen(
        [*command, '--experiments', '400'], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
    ) as program:
        deadline = time.monotonic() + PATIENCE
        while not list(tmp_path.glob('cut.parquet.parts/*.parquet')):
            assert program.poll() is None
            assert time.monotonic() < deadline
        children = Path(f'/proc/{program.pid}/task/{program.pid}/children').read_text().split()
        os.kill(int(children[-1]), signal.SIGKILL)
        err = program.communicate(timeout=PATIENCE)[1]
    assert program.returncode == 1
    assert err.strip().splitlines()[-1].startswith('kapitsa: error: a process that computed was killed')
    assert 'Traceback' not in err
    with pytest.raises(OutputError, match='of another campaign'):  # its factors are others
        kr.campaign(
            ranges=written(tmp_path, factors={'coulomb': [0.0, 8.0]}), experiments=400, output=output, resume=True
        )


@pytest.fixture(scope='module')
def short(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Ranges with a protocol of one speed."""
    folder = tmp_path_factory.mktemp('short')
    protocol = folder / 'one.yaml'
    protocol.write_text('speeds: [2240 rpm]\nrelease: 0.12 rad\nswings: 3\nrepeats: 1\n', encoding='utf-8')
    return written(folder, factors={'protocol': [str(protocol)], 'coulomb': [0.0, 8.0]}, experiments=EACH)


@pytest.fixture(scope='module')
def whole(short: Path) -> Path:
    """Their outcomes."""
    path = short.with_name('whole.parquet')
    kr.campaign(ranges=short, output=path)
    return path


def test_a_killed_campaign_is_resumed_to_the_same_file(short: Path, whole: Path, tmp_path: Path) -> None:
    cut = tmp_path / 'cut.parquet'
    command = [sys.executable, '-m', 'kapitsa_ros', 'campaign', '--ranges', str(short), '--output', str(cut)]
    with subprocess.Popen(command, start_new_session=True, stderr=subprocess.DEVNULL) as program:
        deadline = time.monotonic() + PATIENCE
        while not list(tmp_path.glob('cut.parquet.parts/*.parquet')):
            assert program.poll() is None
            assert time.monotonic() < deadline
        os.killpg(program.pid, signal.SIGKILL)
        assert program.wait() == -signal.SIGKILL
    assert not cut.exists()
    with pytest.raises(OutputError, match='an unfinished campaign is there; go on with it by --resume'):
        kr.campaign(ranges=short, output=cut)
    with pytest.raises(OutputError, match='of another campaign'):
        kr.campaign(ranges=short, output=cut, experiments=3, resume=True)
    resumed = kr.campaign(ranges=short, output=cut, resume=True)
    assert parquet.read_table(cut).equals(parquet.read_table(whole), check_metadata=True)
    assert not (tmp_path / 'cut.parquet.parts').exists()
    again = kr.campaign(ranges=short, output=cut, resume=True)
    assert again.summary == resumed.summary
    with pytest.raises(OutputError, match='is there already and stays'):
        kr.campaign(ranges=short, output=cut)
    rows = parquet.read_table(whole).to_pylist()
    assert [row['point'] for row in rows] == [1] * EACH + [2] * EACH
    assert [row['seed'] for row in rows] == [*range(1, 2 * EACH + 1)]
    units = {field.name: (field.metadata or {}).get(b'unit') for field in parquet.read_schema(whole)}
    assert (units['coulomb'], units['truth_rpm'], units['protocol']) == ('rad/s²'.encode(), b'RPM', None)
    failed = [row for row in rows if row['failure'] is not None]
    assert failed
    assert {row['failure'] for row in failed} == {'no swing could be timed'}
    assert all(row['coulomb'] == 8.0 and row['omega_crit_rpm'] is None for row in failed)


@pytest.mark.slow
def test_a_campaign_killed_ten_times_at_random_moments_gives_the_same_file(tmp_path: Path) -> None:
    whole, cut = tmp_path / 'whole.parquet', tmp_path / 'cut.parquet'
    rng = np.random.default_rng(1997)
    ranges = written(tmp_path, factors={'preset': ['ideal', 'as_built_1997']}, experiments=400)
    undisturbed = kr.campaign(ranges=ranges, output=whole).wall
    parts = cut.with_name(f'{cut.name}.parts')
    for kill in range(10):
        kept = len(list(parts.glob('*.parquet')))
        command = [sys.executable, '-m', 'kapitsa_ros', 'campaign', '--ranges', str(ranges), '--output', str(cut)]
        resumed = ['--resume'] if parts.exists() else []
        deadline = time.monotonic() + PATIENCE
        with subprocess.Popen([*command, *resumed], start_new_session=True, stderr=subprocess.DEVNULL) as program:
            while kill % 2 and len(list(parts.glob('*.parquet'))) == kept:  # else it may be killed before it is at work
                assert program.poll() is None
                assert time.monotonic() < deadline
            with pytest.raises(subprocess.TimeoutExpired):  # else there is nothing left to kill
                program.wait(rng.uniform(0.0, undisturbed / 20))
            os.killpg(program.pid, signal.SIGKILL)
    assert not cut.exists()
    assert len(list(parts.glob('*.parquet'))) >= 5
    kr.campaign(ranges=ranges, output=cut, resume=True)
    assert parquet.read_table(cut).equals(parquet.read_table(whole), check_metadata=True)
    assert not parts.exists()


@pytest.fixture
def cut(whole: Path, tmp_path: Path) -> Path:
    """Path of a campaign of which seeds 1 to 6, 9 to 10 and 13 to 20 are there."""
    path = tmp_path / 'cut.parquet'
    parts = path.with_name('cut.parquet.parts')
    parts.mkdir()
    table = parquet.read_table(whole)
    for first, end in ((0, 6), (8, 10), (12, 20)):
        parquet.write_table(table.slice(first, end - first), parts / f'{first:09}.parquet')
    return path


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.rglob('*.parquet')}


def test_parts_that_are_lost_are_made_again(
    short: Path, whole: Path, cut: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = contents(cut.with_name('cut.parquet.parts'))
    made: dict[str, int] = {}
    add = CampaignFile.add

    def counted(file: CampaignFile, outcomes: list[Outcome]) -> None:
        made[f'{outcomes[0].seed - 1:09}.parquet'] = len(outcomes)
        add(file, outcomes)

    monkeypatch.setattr(CampaignFile, 'add', counted)
    announced = []
    kr.campaign(ranges=short, output=cut, resume=True, progress=lambda stream, total: announced.append(total) or stream)
    assert announced == [4]
    assert made == {'000000006.parquet': 2, '000000010.parquet': 2}
    assert not made.keys() & before.keys()
    assert parquet.read_table(cut).equals(parquet.read_table(whole), check_metadata=True)


@pytest.mark.parametrize(
    ('name', 'rows', 'message'),
    [
        ('000000000 (conflicted copy).parquet', (0, 6), 'is no part, those are named by a number'),
        ('notes.txt', (0, 6), 'is no part'),
        ('000000004.parquet', (4, 8), r'000000004\.parquet has outcomes that 000000000\.parquet has too'),
        ('00000000000.parquet', (0, 6), 'has outcomes that'),
        ('000000006.parquet', (0, 2), 'has not the outcomes from seed 7 on'),
        ('000000006.parquet', (9, 11), 'has not the outcomes from seed 7 on'),
        ('000000020.parquet', (0, 1), 'has not the outcomes from seed 21 on'),
        ('000000006.parquet', None, 'is no Parquet file'),
    ],
)
def test_a_part_that_is_not_what_its_name_says_is_refused_and_all_stays(
    short: Path, cut: Path, name: str, rows: tuple[int, int] | None, message: str
) -> None:
    whole = short.with_name('whole.parquet')
    part = cut.with_name('cut.parquet.parts') / name
    if rows is None:
        part.write_bytes(b'PAR1')
    else:
        parquet.write_table(parquet.read_table(whole).slice(rows[0], rows[1] - rows[0]), part)
    before = contents(cut.parent)
    with pytest.raises(OutputError, match=f'{message}.*; move it elsewhere, --resume makes anew'):
        kr.campaign(ranges=short, output=cut, resume=True)
    assert contents(cut.parent) == before
    part.unlink()
    kr.campaign(ranges=short, output=cut, resume=True)
    assert parquet.read_table(cut).equals(parquet.read_table(whole))


def test_a_part_with_the_points_of_others_is_refused(short: Path, cut: Path) -> None:
    part = cut.with_name('cut.parquet.parts') / '000000012.parquet'
    table = parquet.read_table(part)
    index = table.column_names.index('point')
    parquet.write_table(table.set_column(index, 'point', pa.array([1] * len(table))), part)
    with pytest.raises(OutputError, match='has not the outcomes from seed 13 on'):
        kr.campaign(ranges=short, output=cut, resume=True)


def test_a_part_that_goes_while_others_are_made_is_missed(tmp_path: Path) -> None:
    file = file_of(tmp_path, 4)
    file.add(outcomes_of(range(1, 3)))
    file.add(outcomes_of(range(3, 5)))
    (tmp_path / 'campaign.parquet.parts' / '000000000.parquet').unlink()
    with pytest.raises(OutputError, match='outcomes are missing, from seed 1 on; go on by --resume'):
        file.finish()
    assert not file.path.exists()
    assert file.missing() == [range(2)]


@pytest.mark.parametrize('rows', [[*range(12)], [*range(10), *range(10)], [*range(6), *range(8, 20)]])
def test_a_finished_file_without_all_outcomes_is_no_campaign(
    short: Path, whole: Path, tmp_path: Path, rows: list[int]
) -> None:
    hole = tmp_path / 'hole.parquet'
    parquet.write_table(parquet.read_table(whole).take(rows), hole)
    before = hole.read_bytes()
    with pytest.raises(OutputError, match=r'has not .*outcomes.*; it stays, give another name'):
        kr.campaign(ranges=short, output=hole, resume=True)
    assert hole.read_bytes() == before
    with pytest.raises(OutputError, match=rf'has {len(rows)} outcomes, not 10 at each of 2 points'):
        campaign_report(hole, tmp_path / 'report.md')
    assert not (tmp_path / 'report.md').exists()


@pytest.mark.parametrize('name', [b'caf\xe9.parquet', b'file:z.parquet', b'$x^$.parquet'])
def test_a_file_may_have_any_name(tmp_path: Path, name: bytes) -> None:
    output = tmp_path / os.fsdecode(name)
    kr.campaign(experiments=2, output=output)
    assert [path.name for path in tmp_path.iterdir()] == [os.fsdecode(name)]
    assert read_campaign(output).num_rows == 2


def test_outcomes_of_another_version_are_not_gone_on_with(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    output = tmp_path / 'campaign.parquet'
    kr.campaign(experiments=1, output=output)
    monkeypatch.setattr(campaign_points, 'versions', lambda: {'kapitsa_ros': '0'})
    with pytest.raises(OutputError, match='of another campaign'):
        kr.campaign(experiments=1, output=output, resume=True)


@pytest.fixture
def file(tmp_path: Path) -> CampaignFile:
    return file_of(tmp_path, 4000)


def file_of(folder: Path, experiments: int) -> CampaignFile:
    plain = SimulatedExperiment(
        plant=Plant(), instruments=load_instruments('1997'), protocol=load_protocol('1997'), seed=0
    )
    points = campaign_points.campaign_points(ONE_POINT, plain)
    path = folder / 'campaign.parquet'
    return CampaignFile(path=path, points=points, experiments=experiments, identity='a test', resume=True)


def outcomes_of(seeds: range) -> list[Outcome]:
    values = {'interval': (None, 150.0), 'ols': None, 'inverse_ols': 141.0}
    return [Outcome(seed=seed, omega_crit=140.0 + 1e-3 * seed, seconds=0.01, **values) for seed in seeds]


@contextmanager
def full_disk() -> Iterator[None]:
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1024, limits[1]))
    try:
        with pytest.raises(DiskError, match=r'campaign.parquet: cannot be written \(File too large\); .* --resume'):
            yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)


def test_a_disk_that_fills_keeps_what_was_finished(tmp_path: Path) -> None:
    file = file_of(tmp_path, 4)
    file.add(outcomes_of(range(1, 3)))
    with full_disk():
        file.add(outcomes_of(range(3, 5)))
    assert file.missing() == [range(2, 4)]
    file.add(outcomes_of(range(3, 5)))
    with full_disk():
        file.finish()
    assert file.finish().seed.tolist() == [1, 2, 3, 4]
    assert parquet.read_table(file.path)['low_rpm'].null_count == 4


def test_parts_are_joined_in_their_order_in_little_memory(file: CampaignFile, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(campaign_file, '_PARTS_AT_ONCE', 7)
    for first in range(0, 4000, 100):
        file.add(outcomes_of(range(first + 1, first + 101)))
    found = file.finish()
    assert found.seed.tolist() == list(range(1, 4001))
    assert parquet.read_table(file.path)['seed'].to_pylist() == list(range(1, 4001))
    assert parquet.read_metadata(file.path).num_row_groups == 6  # 40 parts
    assert found.low.tolist() == [-np.inf] * 4000
