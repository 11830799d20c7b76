"""Write what constraints.txt pins, with the SHA-256 of each file that a Linux machine may take.

requirements-build.txt has what builds packages that come as source, requirements.txt all.

Usage: python .ci/lock.py URL..., those of the indexes that pip uses, as PEP 503 has them.
"""

import re
import sys
import urllib.error
import urllib.parse
import urllib.request
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

BUILD = {'packaging', 'setuptools', 'wheel'}
ROOT = Path(__file__).resolve().parent.parent
LINK = re.compile(r'<a [^>]*href="[^"]*#sha256=(?P<hash>[0-9a-f]{64})"[^>]*>\s*(?P<file>[^<]+?)\s*</a>')
WHEEL = re.compile(r'[^-]+-(?P<version>[^-]+)(-\d[^-]*)?-(?P<python>[^-]+)-(?P<abi>[^-]+)-(?P<platform>[^-]+)\.whl')
PYTHON = re.compile(r'py3|py2\.py3|cp31[123]')
PLATFORM = re.compile(r'any|linux_|.*manylinux.*_(x86_64|aarch64)')


def main() -> None:
    """Ask for each package's page, and write the files once all are there."""
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    pins = re.findall(r'^([\w.-]+)==(\S+)$', (ROOT / 'constraints.txt').read_text(encoding='utf-8'), re.MULTILINE)
    with ThreadPoolExecutor(8) as pool:
        locked = dict(zip(pins, pool.map(lambda pin: requirement(sys.argv[1:], *pin), pins), strict=True))
    header = '# By .ci/lock.py, of constraints.txt.'
    build = [header, *(text for (name, _), text in locked.items() if name in BUILD)]
    every = [header, '-r requirements-build.txt', *(text for (name, _), text in locked.items() if name not in BUILD)]
    for file, lines in (('requirements-build.txt', build), ('requirements.txt', every)):
        (ROOT / file).write_text('\n'.join(lines) + '\n', encoding='utf-8')


def requirement(indexes: list[str], name: str, version: str) -> str:
    """Return one package, its version, and the hashes of its wheels, or of its source where it has none."""
    files = {link['file']: link['hash'] for index in indexes for link in LINK.finditer(page(index, normalised(name)))}
    wheels = [hashed for file, hashed in files.items() if (found := WHEEL.fullmatch(file)) and fits(found, version)]
    sources = [hashed for file, hashed in files.items() if is_source(file, name, version)]
    if not wheels and not sources:
        sys.exit(f'{name} {version}: the index has no file of it that fits')
    return ' \\\n    '.join([f'{name}=={version}', *(f'--hash=sha256:{each}' for each in sorted(wheels or sources))])


def page(index: str, name: str) -> str:
    """Return the page of a package, which is empty where an index does not have it."""
    try:
        with urllib.request.urlopen(f'{index.rstrip("/")}/{name}/', timeout=60) as answer:
            return str(answer.read().decode())
    except urllib.error.HTTPError as error:
        if error.code == 404:
            return ''
        raise


def normalised(name: str) -> str:
    """Return a name as PEP 503 has it."""
    return re.sub(r'[-_.]+', '-', name).lower()


def fits(wheel: 're.Match[str]', version: str) -> bool:
    """Tell whether a wheel is of a version, and for Linux and a Python that the package runs on."""
    pythons = wheel['python'].split('.')
    return (
        wheel['version'] == version
        and (bool(PYTHON.fullmatch(wheel['python'])) or 'abi3' in wheel['abi'] or 'py3' in pythons)
        and bool(PLATFORM.match(wheel['platform']))
    )


def is_source(file: str, name: str, version: str) -> bool:
    """Tell whether a file is the source distribution of a version."""
    found = re.fullmatch(r'(.+)-([^-]+)\.(tar\.gz|zip)', urllib.parse.unquote(file))
    return bool(found) and normalised(found[1]) == normalised(name) and found[2] == version


if __name__ == '__main__':
    main()
