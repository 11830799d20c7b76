"""The files of a class: what outlives its server, however that ends."""

from __future__ import annotations

import fcntl
import json
import os
import secrets
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from hashlib import sha256
from itertools import count
from typing import TYPE_CHECKING, TypeVar

import yaml

from kapitsa_ros.configuration.presets import load_preset
from kapitsa_ros.errors import OPTION
from kapitsa_ros.output_file import replacing
from kapitsa_ros.rig.errors import UsageError
from kapitsa_ros.rig.preflight import make_writable
from kapitsa_ros.web.hand_in import HandIn

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from kapitsa_ros.configuration.class_settings import ClassSettings, SealedRod
    from kapitsa_ros.physics.plant import Plant

T = TypeVar('T')
_LETTERS = 'abcdefghjkmnpqrstuvwxyz23456789'
"""None that is taken for another when it is read off a blackboard."""


@dataclass(frozen=True, kw_only=True)
class _ClassRecord:
    identity: str
    """Digest of what is sealed."""
    join_code: str
    token: str


@dataclass(frozen=True, kw_only=True)
class BenchRecord:
    """How a bench stands."""

    key: str
    """In the link of its student."""
    told_length: float
    """m."""
    name: str | None
    """Of its student; None while it is free."""
    joined: str | None
    """When; ISO 8601."""
    run: int
    """The newest."""
    under_way: bool
    """Whether that run has begun and not ended."""
    speed_rpm: float
    """Asked for."""

    @classmethod
    def free(cls, told_length: float) -> BenchRecord:
        """Return that of a bench that nobody has joined, with a new key."""
        key = secrets.token_urlsafe(16)
        return cls(key=key, told_length=told_length, name=None, joined=None, run=0, under_way=False, speed_rpm=0.0)


class BenchFolder:
    """The files of one bench.

    Parameters
    ----------
    path
        The folder; it is made, and the rod sealed in it, where it is not there.
    rod
        To be sealed.

    """

    def __init__(self, path: Path, rod: SealedRod) -> None:
        self.path = path
        self.runs = path / 'runs'
        self.book = path / 'book.csv'
        self._sealed, self._record = path / 'sealed.yaml', path / 'bench.json'
        path.mkdir(exist_ok=True)
        if not self._sealed.exists():
            parameters = yaml.safe_dump({'/**': {'ros__parameters': asdict(rod.plant)}}, sort_keys=False)
            _write(self._sealed, parameters)
        if not self._record.exists():
            self.save(BenchRecord.free(rod.told_length))

    def sealed(self) -> Plant:
        """Return the rod that was sealed."""
        return load_preset(self._sealed)

    def record(self) -> BenchRecord:
        """Return how the bench stands.

        Raises
        ------
        UsageError
            The file is damaged.

        """
        return _read(BenchRecord, self._record)

    def save(self, record: BenchRecord) -> None:
        """Write how the bench stands, as a whole or not at all."""
        _write(self._record, json.dumps(asdict(record)))

    def rig_folders(self) -> list[Path]:
        """Return the folders of runs, one a rig, in their order; the first is there always."""
        later = sorted(self.runs.glob('rig_*'), key=lambda path: int(path.name.removeprefix('rig_')))
        return [self.runs, *later]

    def hand_ins(self) -> list[HandIn]:
        """Return what was handed in, the newest last."""
        return [_read(HandIn, path) for path in sorted(self.path.glob('hand_in_*.json'))]

    def add(self, handed_in: HandIn) -> None:
        """Keep what is handed in; nothing that was handed in before is touched."""
        paths = (self.path / f'hand_in_{number:03d}.json' for number in count(1))
        _write(next(path for path in paths if not path.exists()), json.dumps(asdict(handed_in)))


class ClassFolder:
    """The folder of a class: gone on with where it is there.

    Parameters
    ----------
    path
        Of the folder.
    settings
        Of the class.

    Raises
    ------
    UsageError
        The folder cannot be written, or holds another class or something else.

    """

    def __init__(self, path: Path, settings: ClassSettings) -> None:
        make_writable(path)
        self.path = path
        file = path / 'class.json'
        identity = sha256(settings.identity.encode()).hexdigest()
        self.continued = file.exists()
        """Whether the class was there before."""
        if not self.continued:
            if any(path.iterdir()):
                raise UsageError(
                    f'{OPTION}: is not empty, and holds no class; give another folder', option='bags', value=path
                )
            code = '-'.join(''.join(secrets.choice(_LETTERS) for _ in range(4)) for _ in range(2))
            made = _ClassRecord(identity=identity, join_code=code, token=secrets.token_urlsafe(18))
            _write(file, json.dumps(asdict(made)))
        record = _read(_ClassRecord, file)
        if record.identity != identity:
            raise UsageError(f'{OPTION}: holds a class with other rods; give another folder', option='bags', value=path)
        self.join_code = record.join_code
        """For students."""
        self.token = record.token
        """Of the teacher's link."""
        self.benches = [
            BenchFolder(path / f'bench_{number:02d}', settings.rod(number))
            for number in range(1, settings.numbers.benches + 1)
        ]


def now_text() -> str:
    """Return the wall time, ISO 8601, to the second."""
    return datetime.now(UTC).isoformat(timespec='seconds')


@contextmanager
def alone_in(folder: Path) -> Iterator[None]:
    """Let no other server have a folder while the context lasts; it is made where it is not there.

    Raises
    ------
    UsageError
        Another one has it, or it cannot be written.

    """
    make_writable(folder)
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        os.close(descriptor)
        raise UsageError(f'{OPTION}: is served already; end that server first', option='bags', value=folder) from error
    try:
        yield
    finally:
        os.close(descriptor)


def _read(kind: type[T], path: Path) -> T:
    try:
        return kind(**json.loads(path.read_text(encoding='utf-8')))
    except (OSError, ValueError, TypeError) as error:
        raise UsageError(f'{path}: cannot be read ({error}); put it back, or give another --bags') from error


def _write(path: Path, text: str) -> None:
    """Write a file that nobody but its owner reads, as a whole or not at all."""
    with replacing(path) as draft:
        draft.touch(mode=0o600)
        draft.write_text(text, encoding='utf-8')
