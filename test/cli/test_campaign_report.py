"""The report on a campaign tells each factor's levels by the outcomes in the file."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result
from scipy.stats import binomtest

pa = pytest.importorskip('pyarrow')
pytest.importorskip('matplotlib')
from pyarrow import parquet  # noqa: E402

from kapitsa_ros.cli.commands.report import report  # noqa: E402
from kapitsa_ros.configuration.campaign_ranges import load_ranges  # noqa: E402
from kapitsa_ros.configuration.instrument_sets import load_instruments  # noqa: E402
from kapitsa_ros.configuration.protocols import load_protocol  # noqa: E402
from kapitsa_ros.errors import OutputError  # noqa: E402
from kapitsa_ros.laboratory.campaign import Outcome  # noqa: E402
from kapitsa_ros.laboratory.campaign_file import CampaignFile  # noqa: E402
from kapitsa_ros.laboratory.campaign_points import campaign_points, identity_of  # noqa: E402
from kapitsa_ros.laboratory.simulated_experiment import SimulatedExperiment  # noqa: E402
from kapitsa_ros.physics.plant import Plant  # noqa: E402
from kapitsa_ros.reporting.report.campaign import MOST_LEVELS, Level, campaign_document, level_of, levels_of  # noqa: E402

EACH = 10


def level(held: int, given: int) -> Level:
    return Level(name='', experiments=given, failed=0, held=held, deviation=(0.0, 0.0, 0.0), width=0.1, unbounded=0)


@pytest.mark.parametrize(('held', 'given'), [(0, 5), (5, 5), (19, 20), (380, 400)])
def test_the_range_of_a_share_is_that_of_clopper_and_pearson(held: int, given: int) -> None:
    exact = binomtest(held, given).proportion_ci(0.95, 'exact')
    assert level(held, given).share_range == pytest.approx((exact.low, exact.high))


def test_a_factor_of_many_values_is_taken_in_groups_of_equal_size() -> None:
    columns = {
        'damping': np.linspace(0.0, 1.0, 400),
        **{name: np.ones(400) for name in ('truth_rpm', 'omega_crit_rpm')},
    }
    columns |= {'low_rpm': np.full(400, np.nan), 'high_rpm': np.full(400, 0.5)}
    levels = levels_of('damping', columns)
    assert [each.experiments for each in levels] == [400 // MOST_LEVELS] * MOST_LEVELS
    assert all((each.held, each.unbounded) == (0, each.experiments) for each in levels)  # 1 is above 0.5


def test_groups_hold_whole_values_and_are_named_by_them() -> None:
    def sizes(*values: float) -> list[tuple[str, int]]:
        columns = {
            'gravity': np.array(values),
            **{name: np.ones(len(values)) for name in ('truth_rpm', 'omega_crit_rpm')},
        }
        columns |= {'low_rpm': np.zeros(len(values)), 'high_rpm': np.ones(len(values))}
        return [(each.name, each.experiments) for each in levels_of('gravity', columns)]

    names = ['0', '1', '2', '3', '4 to 5', '6', '7', '8']
    assert sizes(*np.arange(9.0).repeat(2)) == [(name, 4 if 'to' in name else 2) for name in names]
    assert sum(size for _, size in sizes(*[0.0] * 20, *np.linspace(1.0, 2.0, 10))) == 30
    assert sizes(*[0.0] * 20, *np.linspace(1.0, 2.0, 10))[0] == ('0', 20)
    assert [name for name, _ in sizes(9.80661, 9.80662)] == ['9.80661', '9.80662']


def test_where_no_experiment_gave_a_result_no_interval_is_judged() -> None:
    columns = {name: np.full(3, np.nan) for name in ('omega_crit_rpm', 'low_rpm', 'high_rpm')}
    columns |= {'point': np.ones(3), 'seed': np.arange(1, 4), 'truth_rpm': np.ones(3), 'damping': np.zeros(3)}
    columns['failure'] = np.array(['no swing'] * 3, dtype=object)
    text = campaign_document(columns, {'damping': '1/s'}, '0.0.7').text
    assert 'No experiment gave a critical speed' in text
    assert 'intervals hold the exact' not in text
    assert 'kapitsa_ros 0.0.7' in text
    assert '| damping (1/s) |' in text
    assert '| no swing | 3 | seeds 1, 2, 3 |' in text


def test_null_is_an_end_that_excludes_nothing_or_no_result() -> None:
    columns = {
        'truth_rpm': np.full(4, 100.0),
        'omega_crit_rpm': np.array([101.0, 99.0, 102.0, np.nan]),
        'low_rpm': np.array([90.0, np.nan, 101.0, np.nan]),
        'high_rpm': np.array([110.0, np.nan, 110.0, np.nan]),
    }
    found = level_of('all', columns, np.ones(4, dtype=np.bool_))
    assert (found.experiments, found.failed, found.held, found.unbounded) == (4, 1, 2, 1)
    assert found.deviation[0] == pytest.approx(0.01)
    assert found.width == pytest.approx(np.median([0.2, 0.09]))


@pytest.fixture
def campaign(tmp_path: Path) -> Path:
    """Write a campaign: all intervals hold on the ideal rod, half as built, where one experiment failed."""
    ranges = tmp_path / 'ranges.yaml'
    ranges.write_text('factors: {preset: [ideal, as_built_1997]}\n', encoding='utf-8')
    simulated = SimulatedExperiment(
        plant=Plant(), instruments=load_instruments('1997'), protocol=load_protocol('1997'), seed=0
    )
    points = campaign_points(load_ranges(ranges), simulated)
    path = tmp_path / 'campaign.parquet'
    file = CampaignFile(
        path=path, points=points, experiments=EACH, identity=identity_of(points, EACH, {}), resume=False
    )
    outcomes = []
    for number, point in enumerate(points):
        for seed in range(number * EACH + 1, (number + 1) * EACH + 1):
            off = 1.2 if number and seed > EACH + EACH // 2 else 1.0
            lost = seed == 2 * EACH
            outcomes.append(
                Outcome(
                    seed=seed,
                    omega_crit=None if lost else off * point.truth,
                    interval=(None, None) if lost else (off * point.truth * 0.95, off * point.truth * 1.05),
                    ols=None,
                    inverse_ols=None,
                    seconds=0.0,
                    failure='no swing could be timed' if lost else None,
                )
            )
    file.add(outcomes[:7])
    file.add(outcomes[7:])
    assert list(file.finish().failure) == [each.failure for each in outcomes]
    return path


def run(*arguments: object) -> Result:
    return CliRunner().invoke(report, [str(argument) for argument in arguments])


@pytest.mark.parametrize('kind', ['md', 'html', 'pdf'])
def test_a_campaign_becomes_a_report_in_every_format(campaign: Path, tmp_path: Path, kind: str) -> None:
    output = tmp_path / f'report.{kind}'
    assert run('--campaign', campaign, '--output', output).exception is None
    assert output.stat().st_size > 1000
    if kind == 'md':
        text = output.read_text(encoding='utf-8')
        assert '| ideal | 10 | 0 | 100.0 %, 69 to 100 % | +0.00 %, +0.0 to +0.0 % | 10.0 % | 0 |' in text
        assert '| as\\_built\\_1997 | 10 | 1 | 55.6 %, 21 to 86 % | +0.00 %, +0.0 to +20.0 % |' in text
        assert '| no swing could be timed | 1 |' in text
        assert '20 experiments, 10 at each point' in text


def test_what_is_no_campaign_is_refused(tmp_path: Path) -> None:
    other = tmp_path / 'other.parquet'
    parquet.write_table(pa.table({'a': [1]}), other)
    for path, message in ((other, 'is no campaign'), (tmp_path / 'none.parquet', 'no Parquet file')):
        refused = run('--campaign', path, '--output', tmp_path / 'report.html').exception
        assert isinstance(refused, OutputError)
        assert message in str(refused)
    assert run('--output', tmp_path / 'report.html').exit_code == 2
    assert not (tmp_path / 'report.html').exists()
