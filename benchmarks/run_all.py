"""Run every benchmark, one after the other, and write their table into the README, between its two marks."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
BEGIN, END = '<!-- make bench -->', '<!-- end of make bench -->'
SCRIPTS = (
    'smooth_run',
    'friction_run',
    'sampled_block',
    'stability_map',
    'theory_curve',
    'trajectories',
    'reading_bags',
    'first_result',
    'growth',
    'graph_speed',
    'real_time',
)


def main() -> None:
    """Print every claim as JSON, then the table."""
    claims = []
    for script in SCRIPTS:
        output = subprocess.run(  # noqa: S603
            [sys.executable, str(HERE / f'{script}.py')], check=True, stdout=subprocess.PIPE, text=True
        ).stdout
        print(output, end='', flush=True)
        claims += [json.loads(line) for line in output.splitlines()]
    table = '\n'.join(rows(claims)) + '\n'
    write_table(HERE.parent / 'README.md', table)
    print(f'\n{table}')


def write_table(readme: Path, table: str) -> None:
    """Replace what stands between the marks."""
    before, rest = readme.read_text(encoding='utf-8').split(BEGIN)
    _, after = rest.split(END)
    readme.write_text(f'{before}{BEGIN}\n{table}{END}{after}', encoding='utf-8')


def rows(claims: list[dict[str, object]]) -> list[str]:
    """Return the lines of a Markdown table."""
    lines = [
        '| work | peer | target | ratio | ours | peer | our error | peer error |',
        '|---|---|---|---|---|---|---|---|',
    ]
    for claim in claims:
        cells = [claim['work'], claim.get('peer', ''), claim.get('target', '')]
        cells += [_number(claim.get('ratio')), _time(claim.get('ours_s')), _time(claim.get('peer_s'))]
        cells += [_number(claim.get('ours_error')), _number(claim.get('peer_error'))]
        if 'megabytes' in claim:
            cells[4] = f'{claim["megabytes"]:.1f} MB'
        lines.append('| ' + ' | '.join(str(cell) for cell in cells) + ' |')
    return lines


def _number(value: object) -> str:
    return f'{value:.3g}' if isinstance(value, float) else ''


def _time(value: object) -> str:
    if not isinstance(value, float):
        return ''
    for unit, size in (('s', 1.0), ('ms', 1e-3), ('µs', 1e-6), ('ns', 1e-9)):
        if value >= size:
            return f'{value / size:.3g} {unit}'
    return f'{value:g} s'


if __name__ == '__main__':
    main()
