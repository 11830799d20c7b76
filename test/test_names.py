"""The field's standard terms: none of the names that only their author could decode has come back."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
HISTORY = ('CHANGELOG.rst', 'docs/adr/')
"""Where old names may stand."""

OLD_MODULES = {
    'bending', 'critical', 'dark_error', 'delay', 'departure', 'description', 'desk', 'ensemble', 'eye', 'film',
    'guide',
    'hands',
    'join', 'ladder', 'launched', 'many', 'marks', 'offline', 'peers', 'pivot', 'preparation',
    'procedure', 'roster', 'samples', 'screen', 'segments', 'shaft', 'share', 'slow', 'slow_motion', 'spectator',
    'stage',
    'stepping', 'steps', 'thumb', 'view', 'virtual', 'wire', 'pencil', 'laps', 'simulation',
}  # fmt: skip
OLD_CLASSES = {
    'BenchScreen', 'BentTrajectory', 'Client', 'ClockFace', 'Cluster', 'Delay', 'Desk', 'Ears', 'Ends', 'Eye', 'Film',
    'Finding', 'Hands', 'InstrumentStage', 'Join', 'JoinedStage', 'Nodes', 'Observer', 'Pace', 'Peers', 'Picture',
    'PivotError', 'PlantParameters', 'Rung', 'Samples', 'Screen', 'SettingsInbox', 'SlowMotion', 'Spectator', 'Stage',
    'SteadyShaft', 'Thumb', 'Tick', 'Verdict', 'VirtualExperiment', 'Line',
}  # fmt: skip
OLD_FUNCTIONS = {
    'bend', 'dark_error', 'draw_thumb', 'exit_within', 'inverse', 'ladder', 'lap_period', 'no_dead_segments',
    'ordinary',
    'read_tick', 'release_many', 'remove_dead_segments', 'share_path', 'unmask', '_reluctance', '_grip', 'crew', 'mine',
    'hear', 'hear_refusal', 'hear_death', 'fill_rhythm',
}  # fmt: skip
OLD_TERMS = re.compile(
    r'\b(spectators?|rosters?|rungs?|JoinedStage|ClockFace|dark[ _-]error|ticks?|the mend\b|unmask\w*|crew|film|'
    r'departure|thumbs?)\b',
    re.IGNORECASE,
)
"""In headings of documents and in messages to users."""

PYTHON = sorted(
    path
    for folder in ('kapitsa_ros', 'launch', 'examples', 'benchmarks', 'test')
    for path in (ROOT / folder).rglob('*.py')
    if path != Path(__file__)
)
DOCUMENTS = sorted(path for pattern in ('*.md', 'docs/**/*.md', '*.rst') for path in ROOT.glob(pattern))


def definitions(path: Path) -> Iterator[tuple[str, ast.AST]]:
    for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
        if isinstance(node, ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            yield node.name, node


@pytest.mark.parametrize('path', PYTHON, ids=lambda path: str(path.relative_to(ROOT)))
def test_modules_classes_and_functions_have_standard_names(path: Path) -> None:
    if path.is_relative_to(ROOT / 'kapitsa_ros'):
        names = {path.stem, *path.relative_to(ROOT / 'kapitsa_ros').parent.parts}
        assert not names & OLD_MODULES, f'{path.relative_to(ROOT)}: {names & OLD_MODULES}'
    for name, node in definitions(path):
        old = OLD_CLASSES if isinstance(node, ast.ClassDef) else OLD_FUNCTIONS
        assert name not in old, f'{path.relative_to(ROOT)}: {name}'


@pytest.mark.parametrize(
    'path', [path for path in PYTHON if path.is_relative_to(ROOT / 'kapitsa_ros')], ids=lambda path: path.name
)
def test_messages_have_standard_terms(path: Path) -> None:
    """Every text in the code but docstrings: what is logged, raised, printed or shown."""
    tree = ast.parse(path.read_text(encoding='utf-8'))
    docstrings = {
        id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docstrings:
            assert not OLD_TERMS.search(node.value), f'{path.relative_to(ROOT)}: {node.value!r}'


@pytest.mark.parametrize('path', DOCUMENTS, ids=lambda path: str(path.relative_to(ROOT)))
def test_headings_have_standard_terms(path: Path) -> None:
    if str(path.relative_to(ROOT)).startswith(HISTORY):
        pytest.skip('history may use the old names')
    for line in path.read_text(encoding='utf-8').splitlines():
        if line.startswith('#'):
            assert not OLD_TERMS.search(line), line


def test_no_two_files_of_tests_share_a_name() -> None:
    """Beside launch_testing, which wants pytest 7, the second of such a pair is not collected."""
    names = [path.name for path in PYTHON if path.name.startswith('test_')]
    assert sorted(names) == sorted(set(names))
