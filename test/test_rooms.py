"""The house stands: imports point down, and only the nodes know ROS."""

import ast
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / 'kapitsa_ros'
ROOMS = (
    'physics', 'instruments', 'operator', 'network', 'analysis', 'configuration', 'recording', 'laboratory',
    'reporting', 'ros', 'live_view', 'nodes', 'rig', '_api', 'bench', 'web', 'cli',
)  # fmt: skip
ROS = ('rclpy', 'launch', 'launch_ros')
FILES = sorted(path for path in PACKAGE.rglob('*.py') if path.relative_to(PACKAGE).parts[0] in ROOMS)


def imported(path: Path) -> set[str]:
    """Return the absolute names of all modules a file imports, relative imports resolved."""
    here = ('kapitsa_ros', *path.relative_to(PACKAGE).with_suffix('').parts)
    names: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding='utf-8'))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = (
                '.'.join((*here[: len(here) - node.level], *filter(None, [node.module]))) if node.level else node.module
            )
            names |= {f'{base}.{alias.name}' for alias in node.names}
    return names


@pytest.mark.parametrize('path', FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_imports_point_down(path: Path) -> None:
    room = path.relative_to(PACKAGE).parts[0]
    for name in imported(path):
        parts = name.split('.')
        if parts[0] == 'kapitsa_ros' and parts[1] in ROOMS:
            assert ROOMS.index(parts[1]) <= ROOMS.index(room), f'{room} imports {name}'
        if parts[0] in ROS or parts[0].endswith(('_msgs', '_interfaces', '_srvs')):
            assert room in ('ros', 'live_view', 'nodes'), f'{room} imports {name}'


STAND_ON = {
    'ament_index_python', 'builtin_interfaces', 'click', 'diagnostic_msgs', 'distributed', 'domain_coordinator',
    'foxglove', 'fpdf', 'jinja2', 'markdown_it',
    'kapitsa_ros', 'launch', 'launch_ros', 'lz4', 'matplotlib', 'mcap',
    'llvmlite', 'mpl_toolkits', 'numba', 'numpy', 'pandas', 'pyarrow',
    'pytest',
    'rcl_interfaces', 'rclpy', 'rich', 'rosbags', 'rosgraph_msgs', 'scipy', 'sensor_msgs', 'setproctitle', 'starlette',
    'std_msgs', 'std_srvs',
    'textual', 'trajectory_msgs', 'uvicorn', 'uvloop', 'yaml',
    'xarray', 'zstandard',
}  # fmt: skip
"""What setup.py and package.xml declare, by the name it is imported under."""


@pytest.mark.parametrize('path', FILES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_what_is_imported_is_declared(path: Path) -> None:
    """What another package happens to bring may go with its next release."""
    foreign = {name.split('.')[0] for name in imported(path)} - set(sys.stdlib_module_names)
    assert foreign <= STAND_ON, f'{path.relative_to(PACKAGE)} imports {foreign - STAND_ON}'
