"""Figures 2 to 6 of the report, as drawings that scale."""

import kapitsa_ros as kr

print(kr.figures(kr.preset('as_built_1997'), 'figures', speed='2640 rpm', format='svg'))
