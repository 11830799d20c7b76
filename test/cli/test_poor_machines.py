"""The command line where the machine gives little: no width, odd names, foreign styles, libraries that talk."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import matplotlib.image
import pytest
from click.testing import CliRunner

from kapitsa_ros.cli.commands.figures import figures
from kapitsa_ros.cli.foreign_output import foreign_output_on_stderr
from kapitsa_ros.cli.screen_width import forget_useless_width
from kapitsa_ros.errors import shorten

CHECKOUT = Path(__file__).parents[2]


def test_what_a_library_writes_to_stdout_goes_to_stderr(capfd: pytest.CaptureFixture[str]) -> None:
    with foreign_output_on_stderr():
        os.write(1, b'complaint')
    os.write(1, b'result')
    assert capfd.readouterr() == ('result', 'complaint')


def test_a_closed_stdout_is_left_alone() -> None:
    program = 'from kapitsa_ros.cli.foreign_output import *\nwith foreign_output_on_stderr(): pass\nraise SystemExit(7)'
    done = subprocess.run(['/bin/sh', '-c', 'exec "$@" >&-', '-', sys.executable, '-c', program], check=False)
    assert done.returncode == 7


def in_shell(redirection: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, '-m', 'kapitsa_ros', *arguments]
    shell = ['/bin/sh', '-c', f'exec "$@" {redirection}', '-', *command]
    return subprocess.run(shell, capture_output=True, text=True, timeout=120, check=False)


def test_no_work_fails_of_what_is_said_on_stderr() -> None:
    """As in a log on a full disk."""
    done = in_shell('2>/dev/full', 'theory', '--speed', '2240', '--json')
    assert done.returncode == 0
    assert json.loads(done.stdout)['speeds']


def test_a_result_that_cannot_be_written_is_no_success() -> None:
    done = in_shell('>/dev/full', 'theory', '--speed', '2240', '--json')
    assert done.returncode == 1
    assert done.stderr == 'kapitsa: error: [Errno 28] No space left on device: make room there\n'


def test_a_result_that_nobody_could_see_is_not_worked_out() -> None:
    done = in_shell('>&-', 'theory', '--speed', '2240')
    assert done.returncode == 2
    assert done.stderr == 'kapitsa: error: stdout is closed: redirect it, to /dev/null if nothing shall be shown\n'


def without_processes(program: str, stderr: int = subprocess.PIPE) -> subprocess.CompletedProcess[str]:
    """Run a program that is all its user may run; root may run as much as it likes."""
    if os.geteuid() != 0 or not (shutil.which('setpriv') and shutil.which('prlimit')):
        pytest.skip('another user is made by root')
    user = ['setpriv', '--reuid=54322', '--regid=54322', '--clear-groups', '--inh-caps=-all,+dac_read_search']
    user += ['--ambient-caps=-all,+dac_read_search', '--bounding-set=-all,+dac_read_search']
    command = ['prlimit', '--nproc=1', *user, sys.executable, '-c', program]
    return subprocess.run(
        command, env=os.environ | {'TERM': 'xterm'}, stdout=subprocess.PIPE, stderr=stderr, text=True, timeout=120,
        check=False,
    )  # fmt: skip


@pytest.mark.parametrize('start', ['threading.Thread(target=print).start()', 'os.fork()'])
def test_too_few_processes_are_said(start: str) -> None:
    done = without_processes(
        f'import os, threading\nfrom kapitsa_ros.cli import main\nmain.kapitsa.main = lambda **_: {start}\nmain.main()'
    )
    assert (done.returncode, done.stdout) == (1, '')
    assert done.stderr.startswith('kapitsa: error: ')
    assert done.stderr.endswith(': allow more processes and threads, with ulimit -u\n')
    assert done.stderr.count('\n') == 1


def test_no_work_fails_for_want_of_a_thread_that_shows_it() -> None:
    ours, theirs = os.openpty()
    done = without_processes(
        'from kapitsa_ros.cli.progress import counted_off, shown_progress, shown_stages\n'
        'with shown_stages() as show: show("at work")\n'
        'with shown_progress(1) as show: show({"run": "1", "simulated_s": "1", "realtime_factor": "1"})\n'
        'print(sum(counted_off(iter([1, 2]), "numbers", 2)))',
        theirs,
    )
    os.close(theirs)
    os.close(ours)
    assert (done.returncode, done.stdout) == (0, '3\n')


def test_a_current_folder_that_is_gone_is_named(tmp_path: Path) -> None:
    gone = tmp_path / 'gone'
    gone.mkdir()
    command = [sys.executable, '-m', 'kapitsa_ros', 'analyse', 'run']
    shell = ['/bin/sh', '-c', 'cd "$0" && rmdir "$0" && exec "$@"', str(gone), *command]
    environment = os.environ | {'PYTHONPATH': str(CHECKOUT)}
    done = subprocess.run(shell, env=environment, capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, done.stdout) == (1, '')
    assert 'the current folder is gone, change to another' in done.stderr
    assert done.stderr.count('\n') == 1


def test_too_few_file_descriptors_are_said(tmp_path: Path) -> None:
    few = 20
    command = [sys.executable, '-m', 'kapitsa_ros', 'experiment', '--bags', str(tmp_path / 'bags'), '--json']
    shell = ['/bin/sh', '-c', f'ulimit -n {few} && exec "$@"', '-', *command]
    done = subprocess.run(shell, capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, done.stdout) == (1, '')
    assert 'Traceback' not in done.stderr
    assert [line for line in done.stderr.splitlines() if 'kapitsa: error: ' in line and 'Too many open files' in line]


@pytest.mark.parametrize('redirection', ['0<&- 2>&-', '0<&- 1>&- 2>&-'])
def test_nothing_takes_the_place_of_a_stream_that_is_closed(redirection: str, tmp_path: Path) -> None:
    program = (
        'import os, sys, subprocess; from kapitsa_ros.standard_streams import keep_streams_open\n'
        'keep_streams_open(); file = open(sys.argv[1], "w"); print("x", file=sys.stderr); os.write(2, b"y")\n'
        'subprocess.run([sys.executable, "-c", "import os; os.write(2, bytes(1))"], check=True)\n'
        'file.write(str(file.fileno() > 2))'
    )
    shell = ['/bin/sh', '-c', f'exec "$@" {redirection}', '-', sys.executable, '-c', program, str(tmp_path / 'file')]
    assert subprocess.run(shell, check=False).returncode == 0
    assert (tmp_path / 'file').read_text(encoding='utf-8') == 'True'


@pytest.mark.parametrize('redirection', ['0<&-', '1>&-', '2>&-', '0<&- 1>&- 2>&-'])
def test_a_node_starts_without_standard_streams(redirection: str) -> None:
    shell = ['/bin/sh', '-c', f'exec "$@" {redirection}', '-', sys.executable, '-m', 'kapitsa_ros.nodes', 'nobody']
    done = subprocess.run(shell, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith('kapitsa: error: node') or '2>&-' in redirection


@pytest.mark.parametrize(('given', 'left'), [('0', None), ('-1', None), ('', None), ('x', None), ('40', '40')])
def test_a_width_that_holds_no_table_is_none(monkeypatch: pytest.MonkeyPatch, given: str, left: str | None) -> None:
    monkeypatch.setenv('COLUMNS', given)
    forget_useless_width()
    assert os.environ.get('COLUMNS') == left


def test_tables_are_printed_where_the_width_is_unknown(kapitsa) -> None:
    answer = kapitsa('analyse', CHECKOUT / 'bags' / 'run_01_2240rpm', env={'COLUMNS': '0'})
    assert answer.status == 0
    assert '2240' in answer.out
    assert max(map(len, answer.out.splitlines())) > 40


def test_a_file_in_the_current_folder_is_no_module_of_a_node(tmp_path: Path) -> None:
    for name in ('json', 'yaml', 'rclpy'):
        (tmp_path / f'{name}.py').write_text('raise ImportError("of the user")', encoding='utf-8')
    command = [sys.executable, '-P', '-m', 'kapitsa_ros', 'node', 'strobe', '--help']
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, done.stderr) == (0, '')
    assert done.stdout.startswith('usage: strobe')


def test_a_node_is_shown_as_what_it_is(domain: int) -> None:
    command = [sys.executable, '-m', 'kapitsa_ros', 'node', 'strobe']
    with subprocess.Popen(command, stderr=subprocess.PIPE, env=os.environ | {'ROS_DOMAIN_ID': str(domain)}) as node:
        try:
            assert node.stderr is not None
            assert b'joins domain' in node.stderr.readline()
            shown = Path(f'/proc/{node.pid}/cmdline').read_text(encoding='utf-8').rstrip('\0')
            assert shown == f'{sys.executable} -m kapitsa_ros.nodes strobe'
        finally:
            node.terminate()


@pytest.mark.parametrize('arguments', [[], ['theory'], ['bag'], ['bag', 'export'], ['node', 'strobe']])
def test_help_is_the_same_where_python_leaves_docstrings_out(kapitsa, arguments: list[str]) -> None:
    plain, without = (kapitsa(*arguments, '--help', env={'PYTHONOPTIMIZE': level}) for level in ('0', '2'))
    assert (without.status, without.err) == (0, '')
    assert without.out == plain.out


def test_who_ignores_the_ends_of_its_children_can_start_an_experiment(tmp_path: Path) -> None:
    (tmp_path / 'short.yaml').write_text('speeds: [2640 rpm]\nswings: 1\n', encoding='utf-8')
    command = [
        sys.executable,
        '-m',
        'kapitsa_ros',
        'experiment',
        '--protocol',
        'short.yaml',
        '--bags',
        'bags',
        '--json',
    ]
    shell = ['/bin/sh', '-c', 'trap "" CHLD && exec "$@"', '-', *command]
    done = subprocess.run(shell, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)['runs']


def test_a_folder_that_nodes_cannot_be_told_is_refused_before_it_is_made(kapitsa, tmp_path: Path) -> None:
    answer = kapitsa('experiment', '--bags', os.fsdecode(os.fsencode(tmp_path) + b'/caf\xe9'))
    assert answer.status == 2
    assert 'no UTF-8' in answer.err
    assert answer.err.startswith('kapitsa: error: --bags')
    assert answer.err.count('\n') == 1
    assert not list(tmp_path.iterdir())


def test_figures_do_not_depend_on_the_users_style(tmp_path: Path) -> None:
    """LaTeX, which this style asks for, need not be installed."""
    with matplotlib.rc_context({'text.usetex': True, 'axes.facecolor': 'black'}):
        answer = CliRunner().invoke(figures, ['--output', str(tmp_path)])
    assert answer.exit_code == 0, answer.output
    assert len(list(tmp_path.iterdir())) == 5
    corner = matplotlib.image.imread(tmp_path / 'figure_2.png')[5, 5, :3]
    assert corner.min() == 1.0


C = {'LC_ALL': 'C', 'PYTHONUTF8': '0', 'PYTHONCOERCECLOCALE': '0'}


def bag_named(folder: Path, name: bytes) -> Path:
    return shutil.copytree(CHECKOUT / 'bags' / 'run_01_2240rpm', folder / os.fsdecode(name))


@pytest.mark.parametrize(
    ('name', 'shown', 'environment'),
    [
        (b'caf\xe9', 'caf\\xe9', {}),
        ('café'.encode(), 'café', C),
        (b'a$\\frac$b', 'a$\\frac$b', {}),
        (b'two\nlines', 'two\\nlines', {}),
    ],
)
def test_a_report_names_bags_whatever_they_are_called(
    kapitsa, tmp_path: Path, name: bytes, shown: str, environment: dict[str, str]
) -> None:
    bag, page = bag_named(tmp_path, name), tmp_path / 'report.html'
    answer = kapitsa('report', bag, '--output', page, env=environment)
    assert answer.status == 0, answer.err
    assert f'Figure 4: time history of θ, {shown}' in page.read_text(encoding='utf-8')


@pytest.mark.parametrize('kind', ['csv', 'parquet', 'netcdf'])
@pytest.mark.parametrize(('name', 'environment'), [(b'caf\xe9', {}), ('café'.encode(), C), (b'two\nlines', {})])
def test_runs_are_exported_whatever_they_are_called(
    kapitsa, tmp_path: Path, name: bytes, environment: dict[str, str], kind: str
) -> None:
    bag, file = bag_named(tmp_path, name), tmp_path / f'run.{kind}'
    answer = kapitsa('bag', 'export', bag, '--format', kind, '--output', file, env=environment)
    assert answer.status == 0, answer.err
    if kind == 'csv':
        first, second, *_ = file.read_text(encoding='utf-8').splitlines()
        assert first == f'# bag: {name.decode("utf-8", "backslashreplace")}'.replace('\n', '\\n')
        assert second.startswith('# run: ')


def test_figures_need_no_backend(kapitsa, tmp_path: Path) -> None:
    """Jupyter sets one for what is started from it."""
    backend = 'module://no_such_package.backend'
    answer = kapitsa('figures', '--output', tmp_path, '--format', 'svg', '--json', env={'MPLBACKEND': backend})
    assert len(answer.json['figures']) == 5


@pytest.mark.parametrize(
    ('variable', 'given'),
    [
        ('SOURCE_DATE_EPOCH', 'today'),
        ('NUMBA_NUM_THREADS', '0'),
        ('NUMBA_NUM_THREADS', 'x'),
        ('NUMBA_CPU_FEATURES', 'x'),
    ],
)
def test_a_variable_that_no_library_can_use_is_named(kapitsa, tmp_path: Path, variable: str, given: str) -> None:
    answer = kapitsa('figures', '--output', tmp_path, env={variable: given})
    assert (answer.status, answer.out) == (2, '')
    assert answer.err.startswith(f'kapitsa: error: {variable}={given}: must be ')
    assert answer.err.count('\n') == 1


@pytest.mark.parametrize('name', ['figures', 'report'])
def test_settings_of_matplotlib_that_cannot_be_read_are_named(name: str, tmp_path: Path) -> None:
    (tmp_path / 'matplotlibrc').write_bytes(b'font.family: caf\xe9\n')
    arguments = {'figures': [], 'report': [str(CHECKOUT / 'bags' / 'run_01_2240rpm')]}[name]
    command = [sys.executable, '-m', 'kapitsa_ros', name, *arguments, '--output', str(tmp_path / 'drawn.html')]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, done.stdout) == (2, '')
    [line] = [line for line in done.stderr.splitlines() if line.startswith('kapitsa: error: ')]
    assert 'matplotlibrc' in line
    assert 'Traceback' not in done.stderr


def test_a_header_of_a_thousand_numbers_is_told_in_one_line(kapitsa, tmp_path: Path) -> None:
    table = tmp_path / 'wide.csv'
    table.write_text(','.join(f'{200 + n / 10:.18e}' for n in range(3000)))
    answer = kapitsa('reduce', table)
    assert answer.status == 2
    assert 'numbers alone: ' in answer.err
    assert 'and 2994 more' in answer.err
    assert 'name the columns in the first line' in answer.err
    assert len(answer.err) < 500


@pytest.mark.parametrize('size', [500, 1601, 100_000])
def test_a_word_that_somebody_gave_hides_nothing_of_a_line(kapitsa, tmp_path: Path, size: int) -> None:
    ranges = tmp_path / 'ranges.yaml'
    for values, what, mend in (
        (
            f'design: {"x" * size}\nfactors: {{coulomb: [1]}}',
            'design is ',
            ': give one of grid, list, latin_hypercube\n',
        ),
        (f'experiments: [{"x" * size}]\nfactors: {{coulomb: [1]}}', 'experiments is ', ': give a whole number from 1 '),
        (f'factors:\n  ? {"x" * size}\n  : [1]', 'no factor ', ': give some of preset, '),
    ):
        ranges.write_text(values)
        line = kapitsa('campaign', '--ranges', ranges).err
        assert line.startswith(f'kapitsa: error: {ranges}: {what}')
        assert mend in line
        assert len(line) <= 401


def test_signs_that_are_written_out_make_no_line_longer(kapitsa, tmp_path: Path) -> None:
    line = kapitsa('campaign', '--ranges', tmp_path / ('λ ' * 50), env={'PYTHONIOENCODING': 'ascii'}).err
    assert 'lambda lambda' in line
    assert line.endswith('No such file or directory\n')
    assert len(line) < 410


@pytest.mark.parametrize('size', [1, 399, 400, 401, 10_000, 1_000_000])
def test_a_line_is_shortened_in_its_middle(size: int) -> None:
    text = 'begin ' + 'x\n' * size + ' end'
    line = shorten(text)
    assert len(line) <= 400
    assert '\n' not in line
    assert line.startswith('begin x')
    assert line.endswith('x end')
    assert ('…' in line) == (len(' '.join(text.split())) > 400)
