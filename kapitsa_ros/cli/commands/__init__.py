"""One command a file; `kapitsa_ros.cli.main` finds them by name."""
