"""The laboratory of 1997 as ROS 2 nodes."""

import kapitsa_ros as kr

found = kr.experiment('as_built_1997', seed=1997, bags='runs')
print(found)
print(found.to_pandas())
