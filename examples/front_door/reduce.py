"""The critical speed from the readings of 1997."""

import kapitsa_ros as kr

found = kr.reduce('1997')
print(found)
print(found.to_pandas())
found.plot().savefig('reduce.png')
