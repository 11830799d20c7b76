"""Print which kernels NumPy's OpenBLAS takes here: several names of OPENBLAS_CORETYPE stand for the same."""

import ctypes
from pathlib import Path

import numpy as np

[library] = Path(np.__file__).parents[1].glob('numpy.libs/libscipy_openblas*')
name = ctypes.CDLL(str(library)).scipy_openblas_get_corename64_
name.restype = ctypes.c_char_p
print(name().decode())
