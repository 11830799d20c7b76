"""Recorded runs computed again: the same to the last bit, or what differs first."""

import sys

import kapitsa_ros as kr

for run in kr.verify(sys.argv[1:]):
    print(f'{run.bag.name}: {"identical" if run.identical else run.verification.first_difference}')
