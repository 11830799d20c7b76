"""The ROS graph: one thin file a node."""
