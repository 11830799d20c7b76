"""Kernels compiled by Numba, with an entry that takes arrays as Python has them."""

from __future__ import annotations

import re
import sys
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import llvmlite.binding as llvm
import numba
from llvmlite import ir
from numba import types
from numba.core.registry import cpu_target
from numba.extending import intrinsic
from numba.np.arrayobj import make_array, populate_array

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

_OPTIONS = {'fastmath': {'contract'}, 'error_model': 'numpy', '_nrt': False}
_TYPES = {'float': types.float64, 'int': types.int64, 'bool': types.boolean}
_OF_C = re.compile(r'^define [^\n]*@"?cfunc\..*?^\}$', re.MULTILINE | re.DOTALL)
_SIZE = 8
"""Bytes of a double."""
_DATA, _DIMENSIONS = 2, 4
"""Words of an array's object: behind its reference count and type, and behind the number of its dimensions."""


def dispatcher(function: Callable[..., Any]) -> Any:
    """Return a function that Numba compiles into those that call it; it refuses one that makes an array."""
    return numba.njit(**_OPTIONS)(function)


def compile_entry(kernel: Callable[..., Any], parameters: Sequence[int | str], result: str) -> tuple[str, bytes]:
    """Compile a kernel.

    Parameters
    ----------
    kernel
        A `Kernel`.
    parameters
        The number of dimensions of an array, or the annotation of a scalar.
    result
        The annotation of what it returns.

    Returns
    -------
    tuple
        The name of a function, and the machine code with it and all that it calls. It returns 0, and takes places for
        its result and for an exception, and the parameters: an array is the address of its object.

    """
    names = [f'parameter{index}' for index in range(len(parameters))]
    given = [name if kind in _TYPES else f'array({name}, {kind})' for name, kind in zip(names, parameters, strict=True)]
    scope = {'kernel': kernel, 'array': _array}
    exec(f'def entry({", ".join(names)}):\n    return kernel({", ".join(given)})', scope)  # noqa: S102
    signature = _result(result)(*(_TYPES.get(str(kind), types.intp) for kind in parameters))
    with _announced(kernel.__name__):
        compiled = numba.cfunc(signature, **_OPTIONS)(scope['entry'])
        # Around the function is one that C can call, which needs all of Numba where the function raises something.
        module = llvm.parse_assembly(_OF_C.sub('', compiled.inspect_llvm()))
        _, cpu, features = cpu_target.target_context.codegen().magic_tuple()
        machine = llvm.Target.from_triple(module.triple).create_target_machine(
            cpu=cpu, features=features, opt=int(numba.config.OPT), codemodel='jitdefault', jit=True
        )
        return compiled.native_name.removeprefix('cfunc.'), machine.emit_object(module)


def _result(annotation: str) -> Any:
    if annotation == 'None':
        return types.void
    return _TYPES.get(annotation) or types.UniTuple(types.float64, annotation.count('float'))


@intrinsic(prefer_literal=True)
def _array(_: Any, address: Any, dimensions: Any) -> Any:  # noqa: ARG001  # their names are looked at
    """Return the array of doubles in C order whose object lies at an address."""

    def generate(context: Any, builder: ir.IRBuilder, signature: Any, arguments: Sequence[ir.Value]) -> ir.Value:
        word, pointer = ir.IntType(64), ir.IntType(64).as_pointer()

        def word_at(place: ir.Value, index: int) -> ir.Value:
            words = builder.inttoptr(place, pointer)
            return builder.load(builder.gep(words, [word(index)]))

        extents = word_at(arguments[0], _DIMENSIONS)
        shape = [word_at(extents, index) for index in range(signature.return_type.ndim)]
        strides = [word(_SIZE)]
        for extent in shape[:0:-1]:
            strides.insert(0, builder.mul(strides[0], extent))
        data = builder.inttoptr(word_at(arguments[0], _DATA), ir.DoubleType().as_pointer())
        array = make_array(signature.return_type)(context, builder)
        populate_array(array, data=data, shape=shape, strides=strides, itemsize=word(_SIZE), meminfo=None)
        return array._getvalue()  # noqa: SLF001  # as each of Numba's own makers of arrays ends

    return types.Array(types.float64, dimensions.literal_value, 'C')(types.intp, dimensions), generate


@contextmanager
def _announced(name: str) -> Iterator[None]:
    """Say on stderr, where it is a terminal, what is compiled: once after an installation."""
    begin = time.monotonic()
    if sys.stderr.isatty():
        sys.stderr.write(f'kapitsa: compiling {name}, once after an installation\n')
    yield
    if sys.stderr.isatty():
        sys.stderr.write(f'kapitsa: compiled in {time.monotonic() - begin:.1f} s\n')
