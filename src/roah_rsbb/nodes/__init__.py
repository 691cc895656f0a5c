"""One file per ROS node: it connects the other rooms to rospy and contains no rule of the game."""
