"""The plant: parameters, pivot motions, equation of motion, theory. Plain Python that never heard of ROS."""
