"""`python -m kapitsa_ros`: the command line without its script."""

from kapitsa_ros.cli.entry import main

main()
