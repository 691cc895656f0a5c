"""Run logs: one rosbag per run, made from the journal. Format, naming, making."""
