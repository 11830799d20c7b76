from click.testing import CliRunner

from kapitsa_ros.cli.commands.explain import explain


def test_json_has_the_keys_of_the_contract_and_nothing_else_on_stdout(kapitsa):
    result = kapitsa('explain', '--json')
    values = result.json
    assert {'name', 'parameter', 'value', 'interval', 'rms_misfit_s', 'weight'} <= values['explanations'][0].keys()
    assert values['indistinguishable'][:4] == ['inertia_factor', 'large_swing', 'amplitude', 'stopwatch_scale']
    assert 'tuned to 3 points' in result.err


def test_text_names_every_cause():
    output = CliRunner().invoke(explain, []).stdout
    for name in ('inertia_factor', 'strobe_alias', 'clearance', 'instruments'):
        assert name in output
    assert 'none fits' in output
