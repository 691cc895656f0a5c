"""The runs of a competition: shown, exported, and ranked. Reads the journal, and needs no ROS."""
