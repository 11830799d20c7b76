"""Presets, instrument sets, protocols and tables: by name or by path."""

import shutil

import pytest

from kapitsa_ros.analysis.errors import TableError
from kapitsa_ros.configuration.files import shipped_names
from kapitsa_ros.configuration.instrument_sets import load_instruments
from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.configuration.protocols import load_protocol
from kapitsa_ros.configuration.tables import load_table
from kapitsa_ros.instruments.errors import SettingsError
from kapitsa_ros.operator.errors import ProtocolError
from kapitsa_ros.physics.errors import ParameterError
from kapitsa_ros.resources import resource_path

KINDS = {
    'presets': (load_preset, ParameterError, 'ideal', '.yaml'),
    'instruments': (load_instruments, SettingsError, '1997', '.yaml'),
    'protocols': (load_protocol, ProtocolError, '1997', '.yaml'),
    'tables': (load_table, TableError, '1997', '.csv'),
}
PARAMETERS = '/**:\n  ros__parameters:\n    {}\n'


def test_those_that_are_shipped():
    assert shipped_names('presets') == ('as_built_1997', 'bearing', 'ideal')
    assert shipped_names('instruments') == ('1997', 'ideal')
    assert shipped_names('protocols') == shipped_names('tables') == ('1997',)


@pytest.mark.parametrize('folder', KINDS)
def test_all_take_a_name_or_a_path(tmp_path, folder):
    load, _, name, suffix = KINDS[folder]
    mine = tmp_path / f'mine{suffix}'
    shutil.copy(resource_path('config', folder, f'{name}{suffix}'), mine)
    for given in (mine, str(mine), f'{name}{suffix}'):
        assert repr(load(given)).replace('mine', name) == repr(load(name))


@pytest.mark.parametrize('folder', KINDS)
@pytest.mark.parametrize('name', ['nothing', 'x' * 300, 'nul\0', '/no/such'])
def test_what_is_not_there_is_refused_with_the_names_there_are(folder, name):
    load, error, known, suffix = KINDS[folder]
    with pytest.raises(error, match=f'give the path of a {suffix[1:].upper()} file or one of .*{known}'):
        load(name)


def test_a_file_of_ones_own_comes_before_the_shipped_file_of_that_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert load_table('1997.csv').period.size == 3
    (tmp_path / '1997.csv').write_text('forcing_rpm,period_s\n2240,1.0\n')
    assert load_table('1997.csv').period.size == 1
    assert load_table('1997').period.size == 3


@pytest.mark.parametrize(
    ('line', 'complaint'),
    [
        ('lenght: 0.2', 'no parameter lenght'),
        ('reaction_time: 0.2', 'no parameter reaction_time'),
        ('length: long', "length is 'long'"),
        ('length: true', 'length is True'),
        ('length: [0.2]', r'length is \[0.2\]'),
        ('length: -0.2', r'length is -0.2: it must be above 0'),
        ('length: .nan', 'length is nan'),
        ('1: 0.2', 'no parameter 1'),
    ],
)
def test_a_wrong_preset_is_one_error_that_names_file_and_key(tmp_path, line, complaint):
    path = tmp_path / 'mine.yaml'
    path.write_text(PARAMETERS.format(line))
    with pytest.raises(ParameterError, match=f'^{path}: {complaint}'):
        load_preset(path)


@pytest.mark.parametrize('text', ['', '- 1', 'length: 0.2', '/**: 1', '/**: {ros__parameters: }', '{', '\xff'])
def test_what_is_no_params_file_is_refused(tmp_path, text):
    path = tmp_path / 'mine.yaml'
    path.write_bytes(text.encode('latin-1'))
    for load, error in ((load_preset, ParameterError), (load_instruments, SettingsError)):
        with pytest.raises(error, match=f'^{path}'):
            load(path)


def test_a_wrong_instrument_set_names_file_and_key(tmp_path):
    path = tmp_path / 'mine.yaml'
    path.write_text(PARAMETERS.format('reaction_time: 7'))
    with pytest.raises(SettingsError, match=f'^{path}: reaction_time is 7'):
        load_instruments(path)


def test_a_preset_may_be_written_with_units(tmp_path):
    path = tmp_path / 'mine.yaml'
    path.write_text(PARAMETERS.format('length: 9.75in'))
    assert load_preset(path, {'amplitude': '0.5 in'}) == load_preset('ideal')


def test_an_instrument_set_knows_its_name():
    assert load_instruments('ideal', {'reaction_time': 0.1}).name == 'ideal'


def test_a_name_that_stands_twice_is_refused(tmp_path):
    mine = tmp_path / 'mine.yaml'
    mine.write_text(PARAMETERS.format('length: 0.25\n    length: 0.3'))
    with pytest.raises(ParameterError, match="'length' stands twice, in lines 3 and 4"):
        load_preset(mine)
