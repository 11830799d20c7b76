"""Start, drive and stop the graph as processes; the command line."""
