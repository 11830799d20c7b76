"""On machines that give little, commands work or say in one line why they do not: every machine, every command."""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest

pytestmark = pytest.mark.xdist_group('processes')
ROOT = Path(__file__).parents[2]
BAG = ROOT / 'bags' / 'run_01_2240rpm'
NOBODY = 'exec setpriv --reuid=54321 --regid=54321 --clear-groups --inh-caps=-all,+dac_read_search {} "$@"'.format(
    '--ambient-caps=-all,+dac_read_search'
)
"""A user who can read everything and write nothing, as of `docker run --user 54321`."""


@dataclass(frozen=True)
class Machine:
    setting: str = 'exec "$@"'
    """What a shell does before it becomes the command."""
    environment: dict[str, str | None] = field(default_factory=dict)
    """None: unset."""
    wants_root: bool = False
    works: bool | None = True
    """Or it says in one line why not; None: it may do the one or the other."""


def mounted(what: str, **others: object) -> Machine:
    return Machine(f'mount --make-rprivate / && {what} && exec "$@"', wants_root=True, **others)


MACHINES = {
    'HOME unset': Machine(environment={'HOME': None, 'ROS_LOG_DIR': None}),
    'HOME not there': Machine(environment={'HOME': '/proc/nowhere', 'ROS_LOG_DIR': None}),
    'ROS_LOG_DIR bad': Machine(environment={'ROS_LOG_DIR': '/proc/nowhere'}),
    'nothing may be written, no user name': Machine(
        NOBODY, {'HOME': None, 'USER': None, 'LOGNAME': None, 'ROS_LOG_DIR': None}, wants_root=True, works=None
    ),
    'caches of another user': Machine(
        'mkdir -m 700 caches && exec "$@"',
        {'NUMBA_CACHE_DIR': '/proc/nowhere', 'MPLCONFIGDIR': '/proc/nowhere', 'XDG_CACHE_HOME': '/proc/nowhere'},
    ),
    '/dev/shm not there': mounted('mount -t tmpfs -o mode=0 none /dev/shm && umount -l /dev/shm && umount -l /dev/shm'),
    '/dev/shm tiny': mounted('mount -t tmpfs -o size=64k shm /dev/shm', works=None),
    '/dev/shm full': mounted(
        'mount -t tmpfs -o size=1m shm /dev/shm && head -c 1048576 /dev/zero > /dev/shm/full', works=None
    ),
    '/tmp read-only': mounted('mount --bind /tmp /tmp && mount -o remount,ro,bind /tmp'),
    'no /proc/locks': mounted('mount --bind /dev/null /proc/locks'),
    '1024 open files': Machine('ulimit -n 1024 && exec "$@"'),
    '64 open files': Machine('ulimit -n 64 && exec "$@"', works=None),
    'address space of 150 MB': Machine('ulimit -v 150000 && exec "$@"', works=False),
    'address space of 1.2 GB': Machine('ulimit -v 1200000 && exec "$@"', works=None),
    'SIGCHLD ignored': Machine('trap "" CHLD && exec "$@"'),
    'no more processes': Machine(f'exec prlimit --nproc=1 {NOBODY.removeprefix("exec ")}', wants_root=True, works=None),
    'umask 077': Machine('umask 077 && exec "$@"'),
    'umask 777': Machine('umask 777 && exec "$@"', works=None),
    'locale C': Machine(environment={'LC_ALL': 'C', 'PYTHONUTF8': '0', 'PYTHONCOERCECLOCALE': '0'}),
    'latin-1': Machine(environment={'PYTHONIOENCODING': 'latin-1'}),
    'MPLBACKEND of Jupyter': Machine(environment={'MPLBACKEND': 'module://matplotlib_inline.backend_inline'}),
    'MPLBACKEND unknown': Machine(environment={'MPLBACKEND': 'nonsense'}),
    'SOURCE_DATE_EPOCH no number': Machine(environment={'SOURCE_DATE_EPOCH': 'today'}, works=False),
    'NUMBA_NUM_THREADS 0': Machine(environment={'NUMBA_NUM_THREADS': '0'}, works=False),
    'COLUMNS 0': Machine(environment={'COLUMNS': '0'}),
    'COLUMNS 40': Machine(environment={'COLUMNS': '40'}),
    'TERM dumb': Machine(environment={'TERM': 'dumb'}),
    'no TERM': Machine(environment={'TERM': None}),
    'stdout closed': Machine('exec "$@" >&-', works=False),
    'stdout full': Machine('exec "$@" >/dev/full', works=False),
    'stderr closed': Machine('exec "$@" 2>&-'),
    'stderr full': Machine('exec "$@" 2>/dev/full'),
    'stdin closed': Machine('exec "$@" <&-'),
}
COMMANDS = {
    'theory': ['theory', '--speed', '2240', '--json'],
    'analyse': ['analyse', str(BAG), '--json'],
    'figures': ['figures', '--output', 'drawn', '--format', 'svg', '--json'],
    'experiment': ['experiment', '--protocol', 'short.yaml', '--bags', 'bags', '--json'],
}


@pytest.fixture
def folder(name: str, tmp_path: Path) -> Iterator[Path]:
    if name != '/tmp read-only':
        yield tmp_path
        return
    with tempfile.TemporaryDirectory(dir='/var/tmp') as elsewhere:
        yield Path(elsewhere)


@pytest.mark.slow
@pytest.mark.parametrize('command', COMMANDS)
@pytest.mark.parametrize('name', MACHINES)
def test_a_command_works_or_says_why_not(name: str, command: str, folder: Path) -> None:
    machine = MACHINES[name]
    if machine.wants_root and os.geteuid() != 0:
        pytest.skip('this machine is made by root')
    (folder / 'short.yaml').write_text('speeds: [2640 rpm]\nswings: 1\n', encoding='utf-8')
    environment = dict(os.environ)
    for variable, value in machine.environment.items():
        environment.pop(variable, None)
        if value is not None:
            environment[variable] = value
    isolated = ['/usr/bin/unshare', '-m'] if machine.setting.startswith('mount') else []
    called = [sys.executable, '-m', 'kapitsa_ros', *COMMANDS[command]]
    done = subprocess.run(
        [*isolated, '/bin/sh', '-c', machine.setting, '-', *called],
        cwd=folder, env=environment, capture_output=True, text=True, errors='replace', timeout=240, check=False,
    )  # fmt: skip
    if isolated and done.stderr.startswith(('unshare:', 'mount:')):
        pytest.skip(f'no such machine here: {done.stderr}')
    assert 'Traceback' not in done.stderr
    assert 'Exception ignored' not in done.stderr
    if done.returncode == 0:
        assert machine.works is not False
        assert json.loads(done.stdout)
    else:
        assert not machine.works, done.stderr
        assert done.returncode in {1, 2}
        said = [line for line in done.stderr.splitlines() if line.startswith('kapitsa: error: ')]
        assert len(said) == 1, done.stderr
