"""The box's end of the wire: datagrams become events of the core, and the core's messages become datagrams. No ROS."""
