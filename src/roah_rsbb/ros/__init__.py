"""The ROS nodes, and what they share. They connect the other folders to rospy and contain no rule of the game."""
