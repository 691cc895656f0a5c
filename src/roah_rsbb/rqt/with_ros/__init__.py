"""Windows with ROS: what panels need of it, rqt plugins, programs of rosrun and of launch files."""
