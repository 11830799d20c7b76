"""`python -m kapitsa_ros.rig`: the former name of `python -m kapitsa_ros`."""

import runpy

if __name__ == '__main__':
    runpy.run_module('kapitsa_ros', run_name='__main__')
