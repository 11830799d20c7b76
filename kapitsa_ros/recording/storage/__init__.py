"""Storage files of rosbag2, whole or not: messages with their places, and what is damaged or missing."""
