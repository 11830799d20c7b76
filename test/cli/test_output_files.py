"""A file is checked before the work, replaced as a whole, and never left half-written."""

import os
import resource
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import kapitsa_ros
import kapitsa_ros.reporting.report
from kapitsa_ros.cli.commands.analyse import analyse
from kapitsa_ros.cli.commands.bag import bag
from kapitsa_ros.cli.commands.figures import figures
from kapitsa_ros.cli.commands.report import report
from kapitsa_ros.cli.commands.simulate import simulate
from kapitsa_ros.cli.output_files import write_table
from kapitsa_ros.errors import OutputError
from kapitsa_ros.resources import resource_path

IMPOSSIBLE = ('--speed', '2500', '--release', '0.12', '--duration', '2', '--sample-rate', '0')
"""A run that is refused as soon as it begins."""

SHIPPED = resource_path('bags', 'run_01_2240rpm')
WRITERS = {
    'simulate': (simulate, [*IMPOSSIBLE, '--output', 'file.csv']),
    'analyse': (analyse, [str(SHIPPED), '--table', 'file.csv']),
    'report': (report, [str(SHIPPED), '--output', 'file.csv']),
    'figures': (figures, ['--output', 'file.svg']),
    'export': (bag, ['export', str(SHIPPED), '--format', 'csv', '--output', 'file.csv']),
}
"""Every command that writes a file of the user's choice."""


@contextmanager
def full_disk() -> Iterator[None]:
    """No file grows beyond a page."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def fails_to_write(write: Callable[[], object], file: Path) -> None:
    file.write_text('old', encoding='utf-8')
    with full_disk(), pytest.raises(OSError, match=r'too large|requested and') as failure:
        write()
    assert failure.value.errno is None or failure.value.filename == str(file)
    assert file.read_text(encoding='utf-8') == 'old'
    assert list(file.parent.iterdir()) == [file]


@pytest.mark.parametrize('suffix', ['csv', 'npz'])
def test_a_table_that_the_disk_does_not_take_leaves_the_old_one(tmp_path: Path, suffix: str) -> None:
    file = tmp_path / f'motion.{suffix}'
    columns = {'time_s': np.random.default_rng(1).random(10_000)}
    fails_to_write(lambda: write_table(file, columns), file)
    write_table(file, columns)
    assert file.stat().st_size > 4096
    assert list(tmp_path.iterdir()) == [file]


def test_a_report_that_the_disk_does_not_take_leaves_the_old_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip('jinja2')
    pytest.importorskip('matplotlib')
    monkeypatch.setattr(kapitsa_ros.reporting.report, 'gather', lambda *_, **__: None)
    monkeypatch.setattr(kapitsa_ros.reporting.report, 'report_document', lambda _: None)
    monkeypatch.setitem(kapitsa_ros.reporting.report.WRITERS, 'html', lambda _, path: path.write_text('page ' * 10_000))
    file = tmp_path / 'report.html'
    arguments = [str(SHIPPED), '--output', str(file), '--overwrite']
    fails_to_write(lambda: CliRunner().invoke(report, arguments, catch_exceptions=False), file)
    assert CliRunner().invoke(report, arguments).exception is None
    assert file.read_text(encoding='utf-8').startswith('page page')


def test_a_figure_that_the_disk_does_not_take_leaves_the_old_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    figure = pytest.importorskip('matplotlib.figure').Figure()
    figure.subplots().imshow(np.random.default_rng(1).random((300, 300)))
    monkeypatch.setattr('kapitsa_ros.reporting.figures.report_figures', lambda *_: {2: figure})
    fails_to_write(
        lambda: CliRunner().invoke(figures, ['--output', str(tmp_path), '--overwrite'], catch_exceptions=False),
        tmp_path / 'figure_2.png',
    )


@pytest.mark.parametrize('name', WRITERS)
def test_what_is_there_is_kept_unless_asked(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    command, arguments = WRITERS[name]
    for file in ('file.csv', 'file_3.svg'):
        Path(file).write_text('mine', encoding='utf-8')
    refusal = CliRunner().invoke(command, arguments).exception
    assert isinstance(refusal, OutputError)
    assert '--overwrite' in str(refusal)
    assert sorted(path.read_text(encoding='utf-8') for path in tmp_path.iterdir()) == ['mine', 'mine']


def test_what_is_there_is_replaced_where_asked_and_an_empty_file_unasked(tmp_path: Path) -> None:
    """A script may get the name of its file from mktemp."""
    file = tmp_path / 'motion.csv'
    arguments = ['--speed', '2500', '--release', '0.12', '--duration', '1', '--output', str(file)]
    file.touch()
    assert CliRunner().invoke(simulate, arguments).exception is None
    file.write_text('old', encoding='utf-8')
    assert CliRunner().invoke(simulate, [*arguments, '--overwrite']).exception is None
    assert file.read_text(encoding='utf-8').startswith('time_s')


@pytest.mark.parametrize('output', ['motion.txt', 'nowhere/motion.csv'])
def test_simulate_checks_its_output_before_the_work(tmp_path: Path, output: str) -> None:
    result = CliRunner().invoke(simulate, [*IMPOSSIBLE, '--output', str(tmp_path / output)])
    assert isinstance(result.exception, OutputError)
    assert not list(tmp_path.iterdir())


def test_figures_refuse_a_folder_that_cannot_be_made(tmp_path: Path) -> None:
    (tmp_path / 'file').touch()
    result = CliRunner().invoke(figures, ['--output', str(tmp_path / 'file' / 'figures')])
    assert isinstance(result.exception, OutputError)


def test_what_is_no_file_is_written_and_stays(tmp_path: Path) -> None:
    """As /dev/stdout; a link keeps leading to its file."""
    link, file = tmp_path / 'link.csv', tmp_path / 'file.csv'
    file.touch(mode=0o600)
    link.symlink_to(file)
    write_table(link, {'time_s': np.zeros(3)})
    assert link.is_symlink()
    assert len(file.read_text(encoding='utf-8').splitlines()) == 4
    assert file.stat().st_mode & 0o777 == 0o600
    pipe = tmp_path / 'pipe.csv'
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    write_table(pipe, {'time_s': np.zeros(3)})
    assert len(os.read(reader, 4096).splitlines()) == 4
    os.close(reader)
    assert pipe.is_fifo()


def test_a_pipe_without_a_name_is_written(tmp_path: Path) -> None:
    """What /dev/stdout leads to where another program reads it: the link's end is no path."""
    reader, writer = os.pipe()
    link = tmp_path / 'stdout.csv'
    link.symlink_to(f'/dev/fd/{writer}')
    write_table(link, {'time_s': np.zeros(3)})
    assert len(os.read(reader, 4096).splitlines()) == 4
    os.close(writer)
    os.close(reader)


def test_a_folder_is_refused_before_the_work(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match='is a folder'):
        kapitsa_ros.report([SHIPPED], tmp_path)


@pytest.mark.parametrize('suffix', ['csv', 'npz', 'parquet'])
def test_who_reads_a_pipe_gets_the_whole_table(tmp_path: Path, kapitsa: Callable[..., Any], suffix: str) -> None:
    """And has left when it is closed once: a second beginning would wait for the next reader."""
    arguments = ['simulate', '--speed', '2500', '--release', '0.12', '--duration', '1', '--output']
    file, pipe = tmp_path / f'motion.{suffix}', tmp_path / f'pipe.{suffix}'
    os.mkfifo(pipe)
    with subprocess.Popen(['/bin/cat', pipe], stdout=subprocess.PIPE) as reader:
        answers = [kapitsa(*arguments, file), kapitsa(*arguments, pipe)]
        read, _ = reader.communicate()
    assert [answer.status for answer in answers] == [0, 0]
    assert read == file.read_bytes()


@pytest.mark.parametrize('suffix', ['csv', 'npz', 'parquet'])
@pytest.mark.parametrize('name', [b'caf\xe9', b'file:z'])
def test_any_name_is_one_of_a_file(tmp_path: Path, name: bytes, suffix: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    file = Path(os.fsdecode(name + f'.{suffix}'.encode()))
    write_table(file, {'time_s': np.zeros(3)})
    assert list(Path().iterdir()) == [file]
