"""The former name of `kapitsa_ros.physics.compile_kernels`."""

import warnings

from kapitsa_ros.physics.compile_kernels import compile_kernels

warnings.warn('kapitsa_ros.physics.warm is now kapitsa_ros.physics.compile_kernels', DeprecationWarning, stacklevel=2)
warm = compile_kernels

if __name__ == '__main__':
    compile_kernels()
