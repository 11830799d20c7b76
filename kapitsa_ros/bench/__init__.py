"""The bench: a person works the rig in a terminal."""
