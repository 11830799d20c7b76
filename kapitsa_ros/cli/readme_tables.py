"""The tables of parameters in README: `python -m kapitsa_ros.cli.readme_tables README.md` writes them anew."""

from __future__ import annotations

import re
import sys
from pathlib import Path

from kapitsa_ros.analysis.assumptions import Assumptions
from kapitsa_ros.configuration.rig_parameters import RigParameters
from kapitsa_ros.configuration.step_parameters import StepParameters
from kapitsa_ros.instruments.stopwatch_settings import StopwatchSettings
from kapitsa_ros.instruments.strobe_settings import StrobeSettings
from kapitsa_ros.physics.jigsaw_parameters import JigsawParameters
from kapitsa_ros.physics.plant import Plant
from kapitsa_ros.schema import describe

TABLES: dict[str, type] = {
    'plant': Plant,
    'jigsaw': JigsawParameters,
    'steps': StepParameters,
    'rig': RigParameters,
    'strobe': StrobeSettings,
    'stopwatch': StopwatchSettings,
    'assumptions': Assumptions,
}
_MARKED = re.compile(r'(<!-- parameters of (\w+) -->\n).*?(<!-- end of parameters -->)', re.DOTALL)


def table_of(kind: type) -> str:
    """Return the quantities of a parameter set as a table in Markdown."""
    lines = ['| parameter | symbol | unit | default | range | meaning |', '|---|---|---|---|---|---|']
    for item in describe(kind):
        default = f'{item.default:.6g}' if item.kind is float else str(item.default)
        cells = (f'`{item.name}`', item.symbol, item.unit, default, item.range.removeprefix('in '), item.description)
        lines.append('|' + ''.join(f' {cell} |' if cell else ' |' for cell in cells))
    return '\n'.join(lines) + '\n'


def with_tables(text: str) -> str:
    """Return a text with what stands between the markers of each table derived anew."""
    return _MARKED.sub(lambda found: found[1] + table_of(TABLES[found[2]]) + found[3], text)


def main() -> None:
    """Rewrite the tables of the file that the command names."""
    path = Path(sys.argv[1])
    path.write_text(with_tables(path.read_text(encoding='utf-8')), encoding='utf-8')


if __name__ == '__main__':
    main()
