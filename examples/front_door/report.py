"""A report on recorded runs."""

import sys

import kapitsa_ros as kr

print(kr.report(sys.argv[1:], 'report.html', experiments=1))
