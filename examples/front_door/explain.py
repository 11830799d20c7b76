"""Which causes fit the readings of 1997."""

import kapitsa_ros as kr

found = kr.explain('1997')
print(found)
print(found.to_pandas()[['name', 'value', 'rms_misfit_s', 'weight']])
