"""What referees, the public and benchmarking modules are shown."""
