"""The comm node for robots with ROS 2, and a dummy robot."""
