"""Runs the rules of all functionality benchmarks beside a box, in a process or a thread of their own. No ROS."""
