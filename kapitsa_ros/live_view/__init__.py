"""A live view of a rig or a replay: a server of Foxglove's protocol, which stands beside the graph."""
