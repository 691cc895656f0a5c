"""The conformance check of a team's robot: plays the box against one robot and reports what works. No ROS."""
