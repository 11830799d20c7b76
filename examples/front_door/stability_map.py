"""Where the upright rod is stable."""

import numpy as np

import kapitsa_ros as kr

found = kr.stability_map(speed=kr.rpm(np.linspace(500, 4000, 700)), amplitude=np.linspace(0.002, 0.1, 600))
print(found)
found.plot().savefig('stability_map.png')
