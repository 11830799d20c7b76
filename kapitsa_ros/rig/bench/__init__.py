"""The bench: a person's hands on the rig, in a terminal."""
