"""Kapitsa's inverted pendulum on a jigsaw: a plant, its instruments, their analysis and their ROS 2 graph."""

__version__ = '0.1.0'
