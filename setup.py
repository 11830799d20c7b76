"""Build kapitsa_ros for pip and for colcon alike."""

import re
import shutil
from pathlib import Path

from setuptools import find_packages, setup

NAME = 'kapitsa_ros'
SHARE = Path('share') / NAME
SOURCE = Path(__file__).resolve().parent
"""`colcon build --symlink-install` runs a link to this file, beside which are links to what is installed alone."""


def version() -> str:
    """Read the version where it is written; importing the package would need what it depends on."""
    source = Path(NAME, '__init__.py').read_text(encoding='utf-8')
    return re.search(r"^__version__ = '(.+)'$", source, re.MULTILINE)[1]


def installed_tree(folder: str) -> list[tuple[str, list[str]]]:
    """Map every file below `folder` to the same place below share/kapitsa_ros."""
    files: dict[str, list[str]] = {}
    for path in sorted(Path(folder).rglob('*')):
        if path.is_file():
            files.setdefault(str(SHARE / path.parent), []).append(str(path))
    return list(files.items())


def node_scripts() -> list[str]:
    """Write an executable a node, for several in a process and for viewers: the name says what is to be started."""
    folder = Path('build', 'node_scripts')
    folder.mkdir(parents=True, exist_ok=True)
    scripts = []
    nodes = [module.stem for module in Path(NAME, 'nodes').glob('[!_]*.py')]
    for name in sorted(['composed', 'foxglove_server', *nodes]):
        script = folder / name
        shutil.copyfile(Path(SOURCE, 'resource', 'node_script'), script)
        script.chmod(0o755)
        scripts.append(str(script))
    return scripts


CORE = [
    'click>=8.1',
    'llvmlite>=0.42',
    'lz4>=4.0',
    'mcap>=1.1',
    'numba>=0.59,<0.69',  # physics/kernels/compiler.py goes by its native calling convention
    'numpy>=1.26',
    'pyyaml>=6.0',
    'rich>=13.0',
    'ros-ament-index-python>=1.8',
    'ros-jazzy-common-interfaces>=5.3',
    'ros-jazzy-domain-coordinator>=0.12',
    'ros-jazzy-rclpy[fastrtps]>=7.1',
    'rosbags==0.11.9',  # recording/ closes chunks through its storage objects
    'scipy>=1.11',
    'setproctitle>=1.3',
    'zstandard>=0.22',
]
REPORT = [
    'fpdf2>=2.8',
    'jinja2>=3.1',
    'markdown-it-py>=3.0',
    'matplotlib>=3.6',
    'pandas>=2.1',
    'pyarrow>=14',
    'xarray>=2024.1',
]
CAMPAIGN = [
    'distributed>=2024.1',
]
BENCH = [
    'textual>=3.0',
]
WEB = [
    'starlette>=0.37.2',
    'uvicorn>=0.30',
    'uvloop>=0.19',
    'websockets>=15.0',
]
FOXGLOVE = [
    'foxglove-sdk>=0.30',
]
BENCHMARKS = [
    'heyoka',
    'mcap-ros2-support',  # reads bags too
    'mujoco',
]
TEST = [  # under this name `colcon test` looks for pytest
    'GTC>=1.5',  # the uncertainty budget's peer
    'hypothesis',
    'pytest<9',
    'pytest-xdist',
]
DEVELOPMENT = [
    *TEST,
    'axe-playwright-python',  # the browser's tests, and what they look for
    'colcon-common-extensions',
    'mypy',
    'playwright',
    'pytest-random-order',
    'ruff',
    'setuptools<80',  # colcon-core's limit
    'types-PyYAML',
    'wheel',
]

setup(
    name=NAME,
    version=version(),
    description="Kapitsa's inverted pendulum on a jigsaw: the 1997 laboratory as ROS 2 nodes",
    long_description=Path(SOURCE, 'README.md').read_text(encoding='utf-8'),
    long_description_content_type='text/markdown',
    license='Apache-2.0',
    maintainer='kapitsa_ros developers',
    maintainer_email='kapitsa@example.org',
    keywords=['ROS', 'ROS 2', 'inverted pendulum', 'Kapitza pendulum', 'Mathieu equation', 'parametric excitation'],
    classifiers=[
        'Development Status :: 4 - Beta',
        'Framework :: Pytest',
        'Intended Audience :: Education',
        'Intended Audience :: Science/Research',
        'Operating System :: POSIX :: Linux',
        'Programming Language :: Python :: 3 :: Only',
        'Programming Language :: Python :: 3.11',
        'Programming Language :: Python :: 3.12',
        'Topic :: Scientific/Engineering :: Physics',
        'Typing :: Typed',
    ],
    python_requires='>=3.11,<3.13',
    packages=find_packages(include=[NAME, f'{NAME}.*']),
    package_data={NAME: ['py.typed'], f'{NAME}.web': ['static/*', 'words/*.json']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{NAME}']),
        (str(SHARE), ['package.xml']),
        (f'lib/{NAME}', node_scripts()),
        *installed_tree('config'),
        *installed_tree('launch'),
    ],
    install_requires=CORE,
    extras_require={
        'report': REPORT,
        'campaign': CAMPAIGN,
        'bench': BENCH,
        'web': WEB,
        'foxglove': FOXGLOVE,
        'benchmarks': BENCHMARKS,
        'test': TEST,
        'dev': DEVELOPMENT,
        'all': [*REPORT, *CAMPAIGN, *BENCH, *WEB, *FOXGLOVE, *BENCHMARKS, *DEVELOPMENT],
    },
    entry_points={
        'console_scripts': ['kapitsa = kapitsa_ros.cli.entry:main'],
        # The name equals the module path, so that `-p` and the entry point do not register it twice.
        'pytest11': ['kapitsa_ros.rig.pytest_plugin = kapitsa_ros.rig.pytest_plugin'],
    },
    zip_safe=False,
)
