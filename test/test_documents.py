"""Documents say what is: links lead somewhere, names exist, and the version is one."""

import ast
import re
import shlex
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import click
import pytest
import yaml

import kapitsa_ros
from kapitsa_ros.cli.main import kapitsa

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / 'kapitsa_ros'
DOCUMENTS = sorted(path for pattern in ('*.md', 'docs/**/*.md') for path in ROOT.glob(pattern))
WITHOUT_HISTORY = [path for path in DOCUMENTS if path.parent.name != 'adr']
LINK = re.compile(r'\[[^\]]*\]\(([^)\s]+)\)')
DOTTED = re.compile(r'\bkapitsa_ros((?:\.[A-Za-z_]\w*)+)')
PATH = re.compile(r'`((?:[\w.-]+/)+[\w.-]*)`')
PLACES = (ROOT, PACKAGE, ROOT / 'docs')
"""Folders from which documents name a file."""
FILE = ('.py', '.yaml', '.xml', '.json', '/')
"""Endings by which a path is told from a topic."""
ADDED = re.compile(r'^\+\+\+ b/(\S+)$', re.MULTILINE)
"""Files that the diffs of a document add or change."""


README = (ROOT / 'README.md').read_text(encoding='utf-8')
COMMANDS = re.findall(r'^kapitsa (?!node)([^#>\n]+)', README, re.MULTILINE)
SNIPPETS = [
    code
    for code in re.findall(r'^```python\n(.*?)^```', README, re.MULTILINE | re.DOTALL)
    if 'Rig(' not in code and 'def ' not in code
]


def name(path: Path) -> str:
    return str(path.relative_to(ROOT))


@pytest.mark.parametrize('path', DOCUMENTS, ids=name)
def test_links_lead_to_files(path: Path) -> None:
    for target in LINK.findall(path.read_text(encoding='utf-8')):
        if '://' not in target and not target.startswith('#'):
            assert (path.parent / target.partition('#')[0]).exists(), target


def exists(dotted: str) -> bool:
    """Whether a dotted name below the package is a module, or a name at the top level of one."""
    parts = dotted.strip('.').split('.')
    for length in range(len(parts), -1, -1):
        place = PACKAGE.joinpath(*parts[:length])
        file = place / '__init__.py' if place.is_dir() else place.with_suffix('.py')
        if file.is_file():
            return length == len(parts) or parts[length] in defined(file)
    return False


def defined(file: Path) -> set[str]:
    names: set[str] = set()
    for node in ast.walk(ast.parse(file.read_text(encoding='utf-8'))):
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            names.add(node.name)
        elif isinstance(node, ast.ImportFrom):
            names |= {alias.asname or alias.name for alias in node.names}
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
        elif isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == '__all__':
            names |= set(ast.literal_eval(node.value))  # names that are imported when they are asked for
    return names


@pytest.mark.parametrize('path', WITHOUT_HISTORY, ids=name)
def test_modules_that_documents_name_exist(path: Path) -> None:
    text = path.read_text(encoding='utf-8')
    added = {Path(file).with_suffix('').as_posix().replace('/', '.') for file in ADDED.findall(text)}
    for found in DOTTED.finditer(text):
        if not any(found[0].startswith(module) for module in added):
            assert exists(found[1]), found[0]


@pytest.mark.parametrize('path', [path for path in WITHOUT_HISTORY if path.parent == ROOT / 'docs'], ids=name)
def test_files_that_documents_name_exist(path: Path) -> None:
    text = path.read_text(encoding='utf-8')
    for found in PATH.findall(text):
        if found.endswith(FILE) and 'NAME' not in found and found not in ADDED.findall(text):
            assert any((place / found).exists() for place in PLACES), found


def test_the_map_has_every_room() -> None:
    rows = re.findall(
        r'^\| `([a-z_]+)` \|', (ROOT / 'docs' / 'architecture.md').read_text(encoding='utf-8'), re.MULTILINE
    )
    assert len(rows) == len(set(rows))
    assert set(rows) == {path.name for path in PACKAGE.iterdir() if (path / '__init__.py').is_file()}


def test_every_decision_is_in_the_index_and_has_its_parts() -> None:
    folder = ROOT / 'docs' / 'adr'
    records = sorted(path for path in folder.glob('*.md') if path.name != 'README.md')
    assert [int(path.name[:4]) for path in records] == list(range(1, len(records) + 1))
    index = (folder / 'README.md').read_text(encoding='utf-8')
    for path in records:
        text = path.read_text(encoding='utf-8')
        assert f'({path.name})' in index
        assert re.search(r'^- Status: (proposed|accepted|superseded by \d+)$', text, re.MULTILINE), path.name
        assert re.search(r'^- Date: \d{4}-\d\d-\d\d$', text, re.MULTILINE), path.name
        for part in ('Context', 'Decision', 'Consequences'):
            assert f'\n## {part}\n' in text, path.name


def test_the_version_is_one() -> None:
    version = kapitsa_ros.__version__
    assert ET.parse(ROOT / 'package.xml').findtext('version') == version
    citation = yaml.safe_load((ROOT / 'CITATION.cff').read_text(encoding='utf-8'))
    assert {'cff-version', 'message', 'title', 'authors', 'license'} <= citation.keys()
    assert citation['version'] == version
    heading = re.compile(rf'^{re.escape(version)} \(\d{{4}}-\d\d-\d\d\)\n-+$', re.MULTILINE)
    assert heading.search((ROOT / 'CHANGELOG.rst').read_text(encoding='utf-8'))


def test_hooks_before_a_commit_are_local_and_what_make_lint_runs() -> None:
    (source,) = yaml.safe_load((ROOT / '.pre-commit-config.yaml').read_text(encoding='utf-8'))['repos']
    assert source['repo'] == 'local'
    _, _, recipe = (ROOT / 'Makefile').read_text(encoding='utf-8').partition('\nlint: setup\n')
    lines = [line.removeprefix('\t') for line in recipe.partition('\n\n')[0].splitlines()]
    entries = [hook['entry'].replace('.venv/bin', '$(BIN)') for hook in source['hooks']]
    assert [line.removesuffix(' .') for line in lines] == entries


@pytest.mark.parametrize('line', [line.strip() for line in COMMANDS])
def test_the_commands_of_the_readme_are_understood(line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Their names, options and values; tables of the user's own are there."""
    monkeypatch.chdir(tmp_path)
    for table in ('bench_01.csv', 'mine.csv'):
        shutil.copy(ROOT / 'config' / 'tables' / '1997.csv', table)
    word, *arguments = shlex.split(line)
    with click.Context(kapitsa) as context:
        command = kapitsa.get_command(context, word)
        assert command is not None
        if isinstance(command, click.Group):
            command = command.get_command(context, arguments.pop(0))
            assert command is not None
        command.make_context(word, arguments, parent=context)


@pytest.mark.parametrize('number', range(len(SNIPPETS)))
def test_the_python_of_the_readme_runs(number: int) -> None:
    """Those that start a graph are tests of their own, in test/rig."""
    assert len(SNIPPETS) == 2
    done = subprocess.run(
        [sys.executable, '-c', SNIPPETS[number]], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert 'speed' in done.stdout or '0.98' in done.stdout


def test_the_readme_has_every_public_name() -> None:
    assert set(re.findall(r'`kr\.(\w+)`', README)) == set(kapitsa_ros.__all__)
