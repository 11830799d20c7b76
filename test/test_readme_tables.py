"""The tables of parameters in README are those that the schema derives."""

from dataclasses import dataclass
from pathlib import Path

from kapitsa_ros.cli.readme_tables import TABLES, table_of, with_tables
from kapitsa_ros.errors import KapitsaError
from kapitsa_ros.schema import ParameterSet, quantity

README = Path(__file__).parents[1] / 'README.md'


@dataclass(frozen=True, kw_only=True)
class Spring(ParameterSet):
    error = KapitsaError
    stiffness: float = quantity(2.0, 'N/m', 0.0, 5.0, above=True, symbol='k', description='of the spring')
    coils: int = quantity(3, '', 1, 9, description='how many')


def test_a_table():
    assert table_of(Spring).splitlines()[2:] == [
        '| `stiffness` | k | N/m | 2 | above 0, at most 5 | of the spring |',
        '| `coils` | | | 3 | [1, 9] | how many |',
    ]


def test_the_readme_shows_the_tables_that_are_derived():
    text = README.read_text(encoding='utf-8')
    for name in TABLES:
        assert f'<!-- parameters of {name} -->' in text
    assert with_tables(text) == text, 'run: python -m kapitsa_ros.cli.readme_tables README.md'
