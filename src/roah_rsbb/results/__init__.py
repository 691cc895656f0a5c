"""What remains of a competition's runs: shown, exported, and ranked. Reads the journal, and needs no ROS."""
