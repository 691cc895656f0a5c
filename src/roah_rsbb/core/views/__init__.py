"""What the referees, the public and the benchmarking modules see."""
