"""What all programs that talk to the core over ROS share: following its topics, reading its refusals."""
