import json

import pytest
from click.testing import CliRunner

from kapitsa_ros.analysis.errors import TableError
from kapitsa_ros.cli.commands.reduce import reduce

KEYS = {
    'ols_rpm', 'inverse_rpm', 'eiv_rpm', 'eiv_interval_rpm', 'eiv_discrepancy_percent', 'slope_ratio', 'predicted_rpm',
    'error_percent', 'omega_crit_rpm', 'omega_crit_interval_rpm', 'discrepancy_percent', 'play_probability',
    'heavy_damping_probability', 'effective_rods', 'assumptions',
}  # fmt: skip


def run(*arguments):
    result = CliRunner().invoke(reduce, arguments)
    assert result.exception is None, result.exception
    return result.output


@pytest.mark.parametrize('table', [[], ['1997'], ['1997.csv'], ['config/tables/1997.csv']])
def test_table_of_1997(table, request, monkeypatch):
    monkeypatch.chdir(request.config.rootpath)
    values = json.loads(run(*table, '--json'))
    assert set(values) == KEYS
    assert values['ols_rpm'] == pytest.approx(1636.2478, abs=1e-4)
    assert values['inverse_rpm'] == pytest.approx(1639.9930, abs=1e-4)
    assert values['predicted_rpm'] == pytest.approx(1353.0584, abs=1e-4)
    assert values['slope_ratio'] == pytest.approx(0.51452, abs=1e-5)
    assert values['error_percent'] == pytest.approx(21.2, abs=0.05)


def test_unbounded_ends_are_null_and_said(tmp_path):
    table = tmp_path / 'flat.csv'
    table.write_text('forcing_rpm,period_s\n2240,0.62\n2640,0.60\n2780,0.59\n')
    assert json.loads(run(str(table), '--json'))['eiv_interval_rpm'][0] is None
    assert 'unbounded' in run(str(table))


def test_readings_off_any_line_widen_the_interval_and_are_said_to(tmp_path, kapitsa):
    table = tmp_path / 'apart.csv'
    table.write_text('forcing_rpm,period_s,period_sigma_s\n2240,1.00,0.001\n2240,0.98,0.001\n2780,0.68,0.001\n')
    answer = kapitsa('reduce', table, '--json')
    values = answer.json
    assert 'is added to its uncertainty' in answer.err
    # √(((1 − 0.98)² / 2) / (1 dof)) = 1.4 % of a period
    assert values['eiv_discrepancy_percent'] == pytest.approx(1.43, abs=0.05)
    low, high = values['eiv_interval_rpm']
    assert low is None
    assert high == pytest.approx(1969.85, rel=1e-3)
    table.write_text('forcing_rpm,period_s,period_sigma_s\n2240,3.00,0.001\n2240,0.7,0.001\n2780,0.68,0.001\n')
    answer = kapitsa('reduce', table, '--json')
    assert 'contradict one another' in answer.err
    assert answer.json['eiv_interval_rpm'] == [None, None]


def test_runs_that_contradict_are_refused(tmp_path):
    table = tmp_path / 'slowing.csv'
    table.write_text('forcing_rpm,period_s\n2240,0.6\n2640,0.7\n')
    assert isinstance(CliRunner().invoke(reduce, [str(table)]).exception, TableError)


def test_other_rods_have_other_predictions():
    assert json.loads(run('--amplitude', '0.375in', '--json'))['predicted_rpm'] == pytest.approx(1804.08, abs=0.01)


def test_the_timings_of_bags_reduce_to_what_the_bags_do(request, tmp_path, kapitsa):
    bags = sorted((request.config.rootpath / 'bags').glob('run_*'))
    table = tmp_path / 'timings.csv'
    from_bags = kapitsa('analyse', *bags, '--table', table, '--json').json
    ruler = from_bags['ruler']
    options = ('--amplitude', ruler['amplitude_m'], '--amplitude-sigma', ruler['sigma_m'])
    from_table = kapitsa('reduce', table, *options, '--json').json
    for key in ('omega_crit_rpm', 'inverse_rpm', 'ols_rpm'):
        assert from_table[key] == pytest.approx(from_bags[key], rel=1e-9)
    assert from_table['omega_crit_interval_rpm'] == pytest.approx(from_bags['omega_crit_interval_rpm'], rel=1e-6)


def test_one_speed_has_a_curve_and_no_line(tmp_path):
    table = tmp_path / 'one.csv'
    table.write_text('forcing_rpm,period_s,release_rad,kind\n2240,0.6105,0.12,timed\n1300,,0.12,fell\n')
    values = json.loads(run(str(table), '--json'))
    assert values['ols_rpm'] is values['inverse_rpm'] is values['error_percent'] is None
    low, high = values['omega_crit_interval_rpm']
    assert 1290 < low < values['omega_crit_rpm'] < high
    assert 'exact curve' in run(str(table))


def test_missing_file_is_named_as_it_was_given():
    error = CliRunner().invoke(reduce, ['/nowhere/1997.csv']).exception
    assert isinstance(error, TableError)
    assert "no table '/nowhere/1997.csv'" in str(error)


def test_timings_without_a_release_are_said_to_be_taken_as_small_swings(tmp_path):
    said = 'timings without a release angle are taken as small swings'
    assert f'{said}: 3' in run()
    table = tmp_path / 'told.csv'
    table.write_text('forcing_rpm,period_s,release_rad\n2240,1.00,0.12\n2640,0.75,0.12\n2780,0.68,0.12\n')
    assert said not in run(str(table))
