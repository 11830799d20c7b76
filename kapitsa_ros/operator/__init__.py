"""The person who operates the rig: a protocol carried out, or requests turned into commands."""
