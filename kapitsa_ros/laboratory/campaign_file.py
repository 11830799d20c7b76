"""The outcomes of a campaign in a Parquet file, which grows in parts: what was finished is kept, whatever happens."""

from __future__ import annotations

import hashlib
import math
import os
import shutil
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

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
UNIT = b'unit'
"""Of a column, in the metadata of its field; factors are in SI."""


@dataclass(kw_only=True)
class CampaignFile:
    """A campaign's file and its parts, which lie in a folder beside it until all is there.

    Raises
    ------
    OutputError
        It cannot be written, is there already, or holds another campaign.
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
        if self.path.exists():
            self._refuse_other(self.path)
            if not self.resume:
                raise self._refused(f'{OPTION}: is there already and stays; give another name')
        found = self._part_paths()
        if found and not self.resume:
            raise self._refused(
                f'{OPTION}: an unfinished campaign is there; go on with it by --resume, or remove {self._parts}'
            )
        for part in found:
            self._refuse_other(part)

    def done(self) -> int:
        """Return how many outcomes are there already: they are the first ones."""
        if self.path.exists():
            return int(_parquet().read_metadata(self.path).num_rows)
        return sum(_parquet().read_metadata(part).num_rows for part in self._part_paths())

    def add(self, outcomes: Sequence[Outcome], first: int) -> None:
        """Write the next outcomes, of which `first` is the number.

        Raises
        ------
        DiskError
            The disk does not take them.

        """
        with self._naming_the_file():
            self._parts.mkdir(exist_ok=True)
            with replacing(self._parts / f'{first:09}.parquet') as draft:
                _parquet().write_table(self._table(outcomes, first), draft)

    def finish(self) -> Outcomes:
        """Make one file of the parts; return all outcomes, those of earlier starts too, whose seconds are not known.

        Raises
        ------
        DiskError
            The disk does not take it.

        """
        if not self.path.exists():
            with self._naming_the_file(), replacing(self.path) as draft:
                self._join_parts(draft)
            shutil.rmtree(self._parts)
        outcomes = Outcomes()
        with _parquet().ParquetFile(self.path) as file:
            for batch in file.iter_batches(_ROWS_AT_ONCE):
                for row in batch.to_pylist():
                    outcomes.add(_outcome(row))
        return outcomes

    def _join_parts(self, path: Path) -> None:
        """Write what the parts hold, so many rows at once that a reader takes them quickly and memory stays small."""
        import pyarrow as pa  # noqa: PLC0415

        parquet, parts = _parquet(), self._part_paths()
        with parquet.ParquetWriter(path, parquet.read_schema(parts[0])) as writer:
            for begin in range(0, len(parts), _PARTS_AT_ONCE):
                some = parts[begin : begin + _PARTS_AT_ONCE]
                writer.write_table(pa.concat_tables([parquet.read_table(part) for part in some]))

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
        return sorted(self._parts.glob('*.parquet'))

    def _refuse_other(self, path: Path) -> None:
        try:
            metadata = _parquet().read_schema(path).metadata or {}
        except (OSError, ValueError) as error:
            raise self._refused(f'{OPTION}: {path} is no Parquet file ({error})') from error
        if metadata.get(_IDENTITY) != self._digest:
            raise self._refused(f'{OPTION}: {path} is of another campaign and stays; give another name')

    def _refused(self, message: str) -> OutputError:
        return OutputError(message, option='output', value=self.path)

    def _table(self, outcomes: Sequence[Outcome], first: int) -> pa.Table:
        import pyarrow as pa  # noqa: PLC0415

        rows = list(self._rows(outcomes, first))
        factors = self.points[0].factors
        schema = pa.schema(
            [
                ('point', pa.int64()),
                ('seed', pa.int64()),
                *(_factor_field(name, value) for name, value in factors.items()),
                *(pa.field(name, pa.float64(), metadata={UNIT: b'RPM'}) for name in OUTCOME_COLUMNS[2:]),
                ('failure', pa.string()),
            ],
            metadata={_IDENTITY: self._digest, _ABOUT: __version__.encode()},
        )
        return pa.Table.from_pylist(rows, schema=schema)

    def _rows(self, outcomes: Sequence[Outcome], first: int) -> Iterator[dict[str, Any]]:
        for number, outcome in enumerate(outcomes, start=first):
            index = number // self.experiments
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


def _parquet() -> Any:
    return import_of_extra('pyarrow.parquet', 'Parquet', 'report')


def read_campaign(path: Path) -> pa.Table:
    """Read the outcomes of a finished campaign.

    Raises
    ------
    OutputError
        It is no such file.

    """
    parquet = _parquet()
    try:
        table = parquet.read_table(path)
    except (OSError, ValueError) as error:
        raise OutputError(f'{path} is no Parquet file of a campaign ({error})') from error
    if _IDENTITY not in (table.schema.metadata or {}):
        raise OutputError(f'{path} is no campaign: give a file that `kapitsa campaign --output` has written')
    return table


def version_of(table: pa.Table) -> str:
    """Return the version of this package that has carried a campaign out."""
    return str(table.schema.metadata[_ABOUT].decode())
