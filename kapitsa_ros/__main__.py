"""`python -m kapitsa_ros.rig`: the command line without its script."""

from kapitsa_ros.cli.main import main

main()
