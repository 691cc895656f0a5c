"""The journal, the durable record of a competition: written, read, copied to other places; and each run's rosbag."""
