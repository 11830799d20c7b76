"""What the nodes say to each other: numbered steps, roles, topics with their codecs, the synchroniser, the run."""
