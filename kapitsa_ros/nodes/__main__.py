"""`python -m kapitsa_ros.nodes NAME`: see `process`."""

import sys

from kapitsa_ros.ros.signals import leave_on_signals

if __name__ == '__main__':
    leave_on_signals()  # the import takes half a second
    from kapitsa_ros.ros.main import main

    sys.exit(main())
