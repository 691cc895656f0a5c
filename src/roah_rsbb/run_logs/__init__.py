"""Run logs: one rosbag per run. Writing, repairing, naming, reading."""
