"""One run, and its slow motion."""

import kapitsa_ros as kr

run = kr.simulate(kr.Plant(), speed='2500 rpm', release='7 deg', duration='1 min')
print(run)
print(run.to_pandas().tail())
run.plot().savefig('simulate.png')
