"""The outcomes of a campaign in a Parquet file, which grows in parts: what was finished is kept, whatever happens."""

from __future__ import annotations

import hashlib
import math
import os
import shutil
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from kapitsa_ros import __version__
from kapitsa_ros.configuration.campaign_ranges import QUANTITIES
from kapitsa_ros.errors import OPTION, OutputError
from kapitsa_ros.extras import import_of_extra
from kapitsa_ros.laboratory.campaign import Outcome
from kapitsa_ros.laboratory.errors import DiskError
from kapitsa_ros.laboratory.outcomes import Outcomes
from kapitsa_ros.output_file import check_output, replacing
from kapitsa_ros.units import RPM, in_rpm

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    import pyarrow as pa  # type: ignore[import-not-found,import-untyped,unused-ignore]

    from kapitsa_ros.configuration.campaign_ranges import Value
    from kapitsa_ros.laboratory.campaign_points import CampaignPoint

OUTCOME_COLUMNS = ('point', 'seed', 'truth_rpm', 'omega_crit_rpm', 'low_rpm', 'high_rpm', 'ols_rpm', 'inverse_rpm')
"""Numbers of each experiment, beside its factors; null where there is none, or an end is unbounded."""
_ROWS_AT_ONCE = _PARTS_AT_ONCE = 1024
"""That are in memory."""
_IDENTITY = b'kapitsa_ros.campaign'
_ABOUT = b'kapitsa_ros.version'
_POINTS, _EXPERIMENTS = b'kapitsa_ros.points', b'kapitsa_ros.experiments'
"""How many points a finished file has, and experiments at each."""
_ELSEWHERE = 'move it elsewhere, --resume makes anew what is missing'
"""What to do about a part."""
UNIT = b'unit'
"""Of a column, in the metadata of its field; factors are in SI."""


@dataclass(kw_only=True)
class CampaignFile:
    """A campaign's file and its parts, which lie in a folder beside it until all is there.

    Outcomes are numbered from 0 on, their seeds are one more. A part has consecutive ones; the first is its name.

    Raises
    ------
    OutputError
        It cannot be written, is there already, or holds another campaign or not all of this one.
    MissingPackageError
        Pyarrow is not installed.

    """

    path: Path
    points: tuple[CampaignPoint, ...]
    experiments: int
    """At each point."""
    identity: str
    resume: bool

    def __post_init__(self) -> None:
        _parquet()
        check_output(self.path, overwrite=True)  # what is there is a campaign, and stays
        self._digest = hashlib.sha256(self.identity.encode()).hexdigest().encode()
        self._parts = self.path.with_name(f'{self.path.name}.parts')
        self._all = range(len(self.points) * self.experiments)
        if self.path.exists():
            self._refuse_unfinished()
            if not self.resume:
                raise self._refused(f'{OPTION}: is there already and stays; give another name')
        if not self.resume and self._part_paths():
            raise self._refused(
                f'{OPTION}: an unfinished campaign is there; go on with it by --resume, or remove {self._parts}'
            )

    def missing(self) -> list[range]:
        """Return the numbers of the outcomes that are not there yet.

        Raises
        ------
        OutputError
            A part does not hold what its name says.

        """
        return [] if self.path.exists() else self._between([numbers for numbers, _ in self._numbered_parts()])

    def add(self, outcomes: Sequence[Outcome]) -> None:
        """Write a part: outcomes of consecutive numbers.

        Raises
        ------
        DiskError
            The disk does not take them.

        """
        with self._naming_the_file():
            self._parts.mkdir(exist_ok=True)
            with replacing(self._parts / f'{_number(outcomes[0]):09}.parquet') as draft, draft.open('wb') as file:
                _parquet().write_table(self._table(outcomes), file)

    def finish(self) -> Outcomes:
        """Make one file of the parts; return all outcomes, those of earlier starts too, whose seconds are not known.

        Raises
        ------
        DiskError
            The disk does not take it.
        OutputError
            Outcomes are missing; the parts stay.

        """
        if self.path.exists():
            self._refuse_unfinished()
        else:
            parts = self._numbered_parts()
            if gaps := self._between([numbers for numbers, _ in parts]):
                raise self._refused(f'{OPTION}: outcomes are missing, from seed {gaps[0][0] + 1} on; go on by --resume')
            with self._naming_the_file(), replacing(self.path) as draft:
                self._join([path for _, path in parts], draft)
            shutil.rmtree(self._parts)
        outcomes = Outcomes()
        with self.path.open('rb') as raw, _parquet().ParquetFile(raw) as file:
            for batch in file.iter_batches(_ROWS_AT_ONCE):
                for row in batch.to_pylist():
                    outcomes.add(_outcome(row))
        return outcomes

    def _join(self, parts: Sequence[Path], path: Path) -> None:
        """Write what the parts hold, so many rows at once that a reader takes them quickly and memory stays small."""
        import pyarrow as pa  # noqa: PLC0415

        parquet = _parquet()
        with path.open('wb') as file, parquet.ParquetWriter(file, self._schema()) as writer:
            for begin in range(0, len(parts), _PARTS_AT_ONCE):
                some = parts[begin : begin + _PARTS_AT_ONCE]
                writer.write_table(pa.concat_tables(map(_read_table, some)))

    @contextmanager
    def _naming_the_file(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            why = os.strerror(error.errno) if error.errno else error
            raise DiskError(
                f'{self.path}: cannot be written ({why}); what was finished is kept: make room, then go on by --resume'
            ) from error

    def _part_paths(self) -> list[Path]:
        """Return what is in the folder, without the drafts that a killed program has left."""
        if not self._parts.exists():
            return []
        if not self._parts.is_dir():
            raise self._refused(f'{OPTION}: {self._parts} is no folder, and parts would go there; give another name')
        return sorted(path for path in self._parts.iterdir() if not path.name.startswith('.'))

    def _numbered_parts(self) -> list[tuple[range, Path]]:
        """Return the parts in their order, with the numbers of their outcomes."""
        found = []
        for path in self._part_paths():
            if path.suffix != '.parquet' or not (path.stem.isascii() and path.stem.isdigit()):
                raise self._refused(f'{OPTION}: {path} is no part, those are named by a number; {_ELSEWHERE}')
            found.append((self._numbers(path, int(path.stem), _ELSEWHERE), path))
        found.sort(key=lambda part: part[0].start)
        for (before, kept), (after, path) in pairwise(found):
            if after.start < before.stop:
                raise self._refused(f'{OPTION}: {path} has outcomes that {kept.name} has too; {_ELSEWHERE}')
        return found

    def _between(self, found: Sequence[range]) -> list[range]:
        """Return the numbers that are in none of some ranges, which are in their order."""
        begins = [0, *(numbers.stop for numbers in found)]
        ends = [*(numbers.start for numbers in found), len(self._all)]
        return [range(begin, end) for begin, end in zip(begins, ends, strict=True) if begin < end]

    def _refuse_unfinished(self) -> None:
        mend = 'it stays, give another name'
        if self._numbers(self.path, 0, mend) != self._all:
            raise self._refused(f'{OPTION}: has not all of the {len(self._all)} outcomes; {mend}')

    def _numbers(self, path: Path, first: int, mend: str) -> range:
        """Return the numbers of the outcomes in a file, once it is known that they are those from `first` on."""
        stop = first
        try:
            with path.open('rb') as raw, _parquet().ParquetFile(raw) as file:
                if (file.schema_arrow.metadata or {}).get(_IDENTITY) != self._digest:
                    raise self._refused(f'{OPTION}: {path} is of another campaign and stays; give another name')
                is_due = file.schema_arrow.equals(self._schema())
                for batch in file.iter_batches(_ROWS_AT_ONCE) if is_due else ():
                    numbers = np.arange(stop, stop + batch.num_rows)
                    stop += batch.num_rows
                    seed, point = (batch[name].to_numpy(zero_copy_only=False) for name in ('seed', 'point'))
                    is_due &= bool(np.all((seed == numbers + 1) & (point == numbers // self.experiments + 1)))
        except (OSError, ValueError) as error:
            raise self._refused(f'{OPTION}: {path} is no Parquet file ({error}); {mend}') from error
        if not is_due or stop > len(self._all):
            raise self._refused(f'{OPTION}: {path} has not the outcomes from seed {first + 1} on; {mend}')
        return range(first, stop)

    def _refused(self, message: str) -> OutputError:
        return OutputError(message, option='output', value=self.path)

    def _table(self, outcomes: Sequence[Outcome]) -> pa.Table:
        import pyarrow as pa  # noqa: PLC0415

        return pa.Table.from_pylist(list(self._rows(outcomes)), schema=self._schema())

    def _schema(self) -> pa.Schema:
        import pyarrow as pa  # noqa: PLC0415

        return pa.schema(
            [
                ('point', pa.int64()),
                ('seed', pa.int64()),
                *(_factor_field(name, value) for name, value in self.points[0].factors.items()),
                *(pa.field(name, pa.float64(), metadata={UNIT: b'RPM'}) for name in OUTCOME_COLUMNS[2:]),
                ('failure', pa.string()),
            ],
            metadata={
                _IDENTITY: self._digest,
                _ABOUT: __version__.encode(),
                _POINTS: b'%d' % len(self.points),
                _EXPERIMENTS: b'%d' % self.experiments,
            },
        )

    def _rows(self, outcomes: Sequence[Outcome]) -> Iterator[dict[str, Any]]:
        for outcome in outcomes:
            index = _number(outcome) // self.experiments
            point = self.points[index]
            low, high = outcome.interval
            speeds = (point.truth, outcome.omega_crit, low, high, outcome.ols, outcome.inverse_ols)
            yield {
                'point': index + 1,
                'seed': outcome.seed,
                **point.factors,
                **dict(zip(OUTCOME_COLUMNS[2:], map(in_rpm, speeds), strict=True)),
                'failure': outcome.failure,
            }


def _number(outcome: Outcome) -> int:
    return outcome.seed - 1


def _factor_field(name: str, value: Value) -> pa.Field:
    import pyarrow as pa  # noqa: PLC0415

    if isinstance(value, str):
        return pa.field(name, pa.string())
    return pa.field(name, pa.float64(), metadata={UNIT: QUANTITIES[name].unit.encode()})


def _outcome(row: dict[str, Any]) -> Outcome:
    value, low, high, ols, inverse = (None if row[name] is None else row[name] * RPM for name in OUTCOME_COLUMNS[3:])
    return Outcome(
        seed=row['seed'],
        omega_crit=value,
        interval=(low, high),
        ols=ols,
        inverse_ols=inverse,
        seconds=math.nan,
        failure=row['failure'],
    )


def _read_table(path: Path) -> pa.Table:
    with path.open('rb') as file:  # a name has to be UTF-8 there, and may be taken for an address
        return _parquet().read_table(file)


def _parquet() -> Any:
    return import_of_extra('pyarrow.parquet', 'Parquet', 'report')


def read_campaign(path: Path) -> pa.Table:
    """Read the outcomes of a finished campaign.

    Raises
    ------
    OutputError
        It is no such file, or outcomes are missing.

    """
    _parquet()
    try:
        table = _read_table(path)
    except (OSError, ValueError) as error:
        raise OutputError(f'{path} is no Parquet file of a campaign ({error})') from error
    columns = {*OUTCOME_COLUMNS, 'failure'}
    if _IDENTITY not in (table.schema.metadata or {}) or not columns <= set(table.column_names):
        raise OutputError(f'{path} is no campaign: give a file that `kapitsa campaign --output` has written')
    _refuse_incomplete(path, table)
    return table


def _refuse_incomplete(path: Path, table: pa.Table) -> None:
    metadata, point = table.schema.metadata, table['point'].to_numpy()
    # A file may be older than what it says of its size.
    points = int(metadata.get(_POINTS, point.max(initial=0)))
    experiments = int(metadata.get(_EXPERIMENTS, np.unique(point, return_counts=True)[1].max(initial=0)))
    if len(point) != points * experiments or np.any(point != np.arange(len(point)) // max(experiments, 1) + 1):
        wanted = f'{experiments} at each of {points} points'
        raise OutputError(f'{path} has {len(point)} outcomes, not {wanted}: carry that campaign out again')


def version_of(table: pa.Table) -> str:
    """Return the version of this package that has carried a campaign out."""
    return str(table.schema.metadata[_ABOUT].decode())
