"""The recorded motion as arrays."""

import sys

import kapitsa_ros as kr

motion = kr.read_motion(sys.argv[1])
print(motion.angle.size, 'samples,', motion.gaps, 'gaps')
