"""What theory says of a rod, at a hundred thousand speeds."""

import numpy as np

import kapitsa_ros as kr

found = kr.theory(kr.Plant(), speed=kr.rpm(np.linspace(1000, 3000, 100_000)))
print(found)
print(found.to_pandas().describe())
found.plot().savefig('theory.png')
