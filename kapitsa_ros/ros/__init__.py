"""What every node stands on: the dataflow node, discovery, pacing, shutdown, and clients of the graph."""

from kapitsa_ros.ros.middleware import refuse_missing_middleware
from kapitsa_ros.ros.shared_memory import refuse_full_shared_memory

# Before any module of this room can import rclpy, which would end the process without a word of why.
refuse_missing_middleware()
refuse_full_shared_memory()
