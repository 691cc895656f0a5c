"""The ROS nodes, one file each: they connect the other folders to rospy and contain no rule of the game."""
