"""Node roah_rsbb_web: connects the gateway for browsers to ROS."""
