"""Look for known vulnerabilities of what requirements.txt pins, with pip-audit, which is to be on the path.

Exits with 1 where there are any. Where no data can be had the audit is skipped, with the reason: pip-audit itself says
"no known vulnerabilities" of packages that it found nothing about.
"""

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

REQUIREMENTS = Path(__file__).resolve().parent.parent / 'requirements.txt'


def main() -> None:
    """Run the audit and say what it covers."""
    if not shutil.which('pip-audit'):
        skip('pip-audit is not installed (pip install pip-audit)')
    with tempfile.TemporaryDirectory() as folder:
        found = Path(folder) / 'found.json'
        options = ['--disable-pip', '--require-hashes', '--progress-spinner', 'off', '--format', 'json']
        run = subprocess.run(
            ['pip-audit', *options, '--output', found, '--requirement', REQUIREMENTS],
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
        if not found.is_file():
            skip((run.stderr.strip().splitlines() or ['pip-audit gave no result'])[-1])
        packages = json.loads(found.read_text(encoding='utf-8'))['dependencies']
    known = [package for package in packages if 'vulns' in package]
    if not known:
        skip(f'there is no vulnerability data here of any of {len(packages)} packages')
    print(f'audit: {len(known)} of {len(packages)} packages; no data of the others')
    vulnerable = [(package, each) for package in known for each in package['vulns']]
    for package, each in vulnerable:
        print(f'{package["name"]} {package["version"]}: {each["id"]}, mended in {", ".join(each["fix_versions"])}')
    sys.exit(bool(vulnerable))


def skip(reason: str) -> None:
    """Leave without an error."""
    print(f'audit skipped: {reason}')
    sys.exit(0)


if __name__ == '__main__':
    main()
