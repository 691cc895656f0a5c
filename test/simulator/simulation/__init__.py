"""The whole box in simulated time: computers, network, disks, robots, referees, and everything that may go wrong."""
