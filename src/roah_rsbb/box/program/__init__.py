"""The box as one program, without ROS: `roah-rsbb run FOLDER` and `roah-rsbb demo`."""
