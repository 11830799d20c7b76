"""How kernels are compiled and called."""

from __future__ import annotations

import ctypes
import os
import threading
from functools import update_wrapper
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar, cast

import numpy as np

from kapitsa_ros.physics.kernels.native_code import NativeCode

if TYPE_CHECKING:
    from collections.abc import Callable

_P = ParamSpec('_P')
_R = TypeVar('_R')
_FLOAT = np.dtype(np.float64)
_SCALARS: dict[str, Any] = {'float': ctypes.c_double, 'int': ctypes.c_int64, 'bool': ctypes.c_bool}
_loading = threading.RLock()
"""Held by the one thread that loads or compiles a kernel; a fork waits for it, as the child would for ever."""
os.register_at_fork(before=_loading.acquire, after_in_parent=_loading.release, after_in_child=_loading.release)


def kernel(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Compile on first call and keep the machine code on disk; products and sums may fuse, nothing is reordered.

    A kernel makes no array: it works in those that it is given, of doubles in C order. To count references to arrays
    that it made took as long as the arithmetic where a function works on a few dozen numbers.

    What a kernel calls is compiled into it, so that its last digits depend on nothing else that is loaded. Numba
    compiles it, and is not loaded where machine code is found: that takes ten times as long as the code itself.
    """
    if os.environ.get('NUMBA_DISABLE_JIT', '0') not in {'', '0'}:
        return function
    return cast('Callable[_P, _R]', Kernel(function))


class Kernel:
    """A compiled function of numbers and arrays, which are told apart by its annotations, all of them strings."""

    def __init__(self, function: Callable[..., Any]) -> None:
        update_wrapper(self, function)
        self._function = function
        *self._parameters, self._result = function.__annotations__.values()
        self._arrays = [index for index, name in enumerate(self._parameters) if name not in _SCALARS]
        self._entries: dict[tuple[int, ...], Callable[..., Any]] = {}
        self._codes: list[NativeCode] = []
        self._dispatcher: Any = None

    def __call__(self, *arguments: Any) -> Any:
        """Run the machine code.

        Raises
        ------
        TypeError
            There are too few or too many arguments, or an array is not one of doubles in C order that can be written.

        """
        if len(arguments) != len(self._parameters):  # C would not notice
            raise TypeError(f'{self._function.__name__} takes {len(self._parameters)} arguments, not {len(arguments)}')
        dimensions = tuple([_dimensions(arguments[index]) for index in self._arrays])
        try:
            entry = self._entries[dimensions]
        except KeyError:
            entry = self._loaded(dimensions)
        return entry(*arguments)

    @property
    def _numba_type_(self) -> Any:
        """The type that Numba asks for where another kernel calls this one."""
        if self._dispatcher is None:
            from kapitsa_ros.physics.kernels.compiler import dispatcher  # noqa: PLC0415  # Numba

            self._dispatcher = dispatcher(self._function)
        return self._dispatcher._numba_type_  # by which Numba asks whatever it is given

    def _loaded(self, dimensions: tuple[int, ...]) -> Callable[..., Any]:
        with _loading:
            if dimensions not in self._entries:
                self._entries[dimensions] = self._entry(dimensions)
        return self._entries[dimensions]

    def _entry(self, dimensions: tuple[int, ...]) -> Callable[..., Any]:
        given = iter(dimensions)
        parameters = [name if name in _SCALARS else next(given) for name in self._parameters]
        code = NativeCode(self, parameters, self._result)
        self._codes.append(code)  # it lives as long as the kernel
        types: list[Any] = [_SCALARS.get(name, ctypes.py_object) for name in self._parameters]
        run = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p, *types)(code.address)
        make_result, value_of = _result(self._result)

        def entry(*arguments: Any) -> Any:
            result, exception = make_result(), ctypes.c_void_p()
            if run(ctypes.byref(result), ctypes.byref(exception), *arguments):
                raise RuntimeError(f'{self._function.__name__} has raised an exception')
            return value_of(result)

        return entry


def _result(annotation: str) -> tuple[Any, Callable[[Any], Any]]:
    """Return what makes a place for a result, and what reads it: a scalar, a tuple of floats or nothing."""
    if annotation == 'None':
        return ctypes.c_void_p, lambda _: None
    if annotation in _SCALARS:
        return _SCALARS[annotation], lambda result: result.value
    return ctypes.c_double * annotation.count('float'), tuple


def _dimensions(array: Any) -> int:
    if type(array) is not np.ndarray or (array.dtype is not _FLOAT and array.dtype != _FLOAT) or not array.flags.carray:
        raise TypeError(
            f'{np.asarray(array).dtype} {np.shape(array)}: give an array of doubles in C order that can be written'
        )
    return array.ndim
