"""What every node stands on: the dataflow node, discovery, pacing, shutdown, and clients of the graph."""
