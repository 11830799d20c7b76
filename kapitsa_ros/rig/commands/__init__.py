"""One command a file; `kapitsa_ros.rig.cli` finds them by name."""
