from click.testing import CliRunner

from kapitsa_ros.cli.commands.explain import explain


def test_json_has_the_keys_of_the_contract_and_nothing_else_on_stdout(kapitsa):
    result = kapitsa('explain', '--json')
    values = result.json
    assert {'name', 'parameter', 'value', 'interval', 'rms_misfit_s', 'weight'} <= values['explanations'][0].keys()
    assert values['indistinguishable'][:4] == ['inertia_factor', 'large_swing', 'amplitude', 'stopwatch_scale']
    assert 'tuned to 3 points' in result.err


def test_text_names_every_cause():
    output = CliRunner().invoke(explain, [], env={'COLUMNS': '120'}).stdout
    for name in ('inertia_factor', 'strobe_alias', 'clearance', 'instruments'):
        assert name in output
    assert 'none fits' in output


def test_text_has_values_with_units_beside_nominal_ones_and_ends_with_what_to_do():
    output = ' '.join(CliRunner().invoke(explain, [], env={'COLUMNS': '200'}).stdout.split())
    assert '│ amplitude │ λ │ 9.81 mm │ 9.53 to 10.1 │ 12.7 mm │' in output
    assert 'These readings cannot tell apart: inertia_factor, large_swing' in output
    assert 'Next: `kapitsa plan --target 1 --between inertia_factor large_swing`' in output


def test_json_says_in_which_unit_a_value_is(kapitsa):
    units = {each['name']: each['unit'] for each in kapitsa('explain', '--json').json['explanations']}
    assert (units['amplitude'], units['large_swing'], units['stopwatch_scale']) == ('m', 'rad', '')
    assert (units['damping'], units['coulomb'], units['instruments']) == ('1/s', 'rad/s²', '')
