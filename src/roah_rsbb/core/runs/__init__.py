"""Runs: of one robot, of all robots at once, and of functionality benchmarks."""
