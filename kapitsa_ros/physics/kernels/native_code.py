"""Machine code of kernels: where it is kept, when it is out of date or damaged, and how it is loaded without Numba."""

from __future__ import annotations

import functools
import hashlib
import json
import os
import struct
import sys
import zlib
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

import llvmlite
import llvmlite.binding as llvm
import numpy as np

from kapitsa_ros.numba_settings import numba_settings
from kapitsa_ros.output_file import replacing

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

_HERE = Path(__file__).parent
_CHECKSUM = 4
"""Bytes at the end of what is kept."""
_SYMBOL = struct.Struct('<IBBHQQ')
"""Entry of an ELF file's table of symbols: name, info, other, section, value, size."""


class NativeCode:
    """Machine code of a kernel for parameters of some kind: found on disk, else compiled, and kept there.

    It is kept in NUMBA_CACHE_DIR, beside the source or in the user's cache folder: the first of them that can be
    written. Where none can, each process compiles for itself, and a line on stderr says so.

    Parameters
    ----------
    kernel, parameters, result
        As of `compiler.compile_entry`.

    """

    def __init__(self, kernel: Any, parameters: Sequence[int | str], result: str) -> None:
        _initialise()
        module = kernel.__module__.rpartition('.')[2]
        self._file = '.'.join((module, kernel.__qualname__, *map(str, parameters), sys.implementation.cache_tag, 'o'))
        address = self._kept_address()
        if address is None:
            from kapitsa_ros.physics.kernels.compiler import compile_entry  # noqa: PLC0415  # Numba

            name, code = compile_entry(kernel, parameters, result)
            self._keep(name, code)
            address = self._link(name, code)
            if address is None:
                raise RuntimeError(f'{self._file} calls what is not there')
        self.address = address
        """Where it is in memory, as long as this lives."""

    def _kept_address(self) -> int | None:
        for folder in _folders():
            try:
                kept = (folder / self._file).read_bytes()
            except OSError:
                continue
            header, _, code = kept[:-_CHECKSUM].partition(b'\n')
            if _checksum(kept[:-_CHECKSUM]) == kept[-_CHECKSUM:]:  # after a power cut a file may have but its length
                try:
                    stamp, name = json.loads(header)
                except (TypeError, ValueError):  # of another version
                    continue
                if stamp == _stamp() and (address := self._link(name, code)):
                    return address
        return None

    def _keep(self, name: str, code: bytes) -> None:
        data = json.dumps([_stamp(), name]).encode() + b'\n' + code
        for folder in _folders():
            try:
                folder.mkdir(parents=True, exist_ok=True)
                with replacing(folder / self._file) as draft:
                    draft.write_bytes(data + _checksum(data))
            except OSError:
                continue
            return
        _warn_of_no_cache()

    def _link(self, name: str, code: bytes) -> int | None:
        # An engine of its own: in a common one, of functions that two kernels call the first one loaded serves both.
        machine = llvm.Target.from_default_triple().create_target_machine(codemodel='jitdefault', jit=True)
        self._engine = llvm.create_mcjit_compiler(llvm.parse_assembly(''), machine)
        if not _is_complete(code):
            return None
        self._engine.add_object_file(llvm.ObjectFileRef.from_data(code))
        self._engine.finalize_object()
        return int(self._engine.get_function_address(name))


def _folders() -> Iterator[Path]:
    """Yield the folders in which code may be kept."""
    of_install = hashlib.sha256(os.fsencode(_HERE)).hexdigest()[:16]
    if given := os.environ.get('NUMBA_CACHE_DIR'):
        yield Path(given, f'kapitsa_ros_{of_install}')
    yield _HERE / '__pycache__'
    with suppress(RuntimeError):  # a user without a home
        yield Path(os.environ.get('XDG_CACHE_HOME') or Path('~/.cache').expanduser(), 'kapitsa_ros', of_install)


@functools.cache
def _stamp() -> list[Any]:
    """Return what tells one state of all kernels' sources from another, compiled by one set of rules or another."""
    numba = find_spec('numba')
    of_numba = _state(Path(numba.origin).with_name('_version.py')) if numba and numba.origin else None
    versions = [of_numba, llvmlite.__version__, np.__version__]
    features = ''
    with suppress(RuntimeError):  # a processor of which LLVM knows none, as Numba takes it
        features = llvm.get_host_cpu_features().flatten()
    processor = [llvm.get_host_cpu_name(), features]
    return [*map(_state, sorted(_HERE.glob('*.py'))), *numba_settings(), *versions, *processor]


def _state(path: Path) -> list[Any] | None:
    try:
        found = path.stat()
    except OSError:
        return None
    return [path.name, found.st_mtime_ns, found.st_size]


@functools.cache
def _initialise() -> None:
    """Let LLVM know this processor; newer versions do so themselves."""
    with suppress(RuntimeError):
        llvm.initialize()
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()


def _is_complete(code: bytes) -> bool:
    """Whether this process has all functions that the code calls: LLVM ends the process where one is missing."""
    sections = {section.name(): section.data() for section in llvm.ObjectFileRef.from_data(code).sections()}
    names = sections.get(b'.strtab', b'')
    for name, _, _, section, _, _ in _SYMBOL.iter_unpack(sections.get(b'.symtab', b'')):
        if name and not section and not llvm.address_of_symbol(names[name : names.index(b'\0', name)].decode()):
            return False
    return True


def _checksum(data: bytes) -> bytes:
    return zlib.crc32(data).to_bytes(_CHECKSUM, 'little')


@functools.cache
def _warn_of_no_cache() -> None:
    """Say it once a process."""
    sys.stderr.write(
        'kapitsa: warning: no folder for compiled kernels can be written, each process compiles them again: '
        'set NUMBA_CACHE_DIR to a folder you can write to\n'
    )
