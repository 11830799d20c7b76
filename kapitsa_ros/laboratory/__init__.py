"""Whole experiments without the graph: simulated, in campaigns, and analysed from bags."""
