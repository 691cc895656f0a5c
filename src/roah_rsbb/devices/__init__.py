"""Home devices: the SmartIF protocol, its client and a dummy server; sounds. No ROS."""
