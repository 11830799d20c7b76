"""A recorded run as a data frame."""

import sys

import kapitsa_ros as kr

bag = kr.read_bag(sys.argv[1])
print(bag.run.period, bag.run.fell)
print(bag.motion.to_pandas().describe())
