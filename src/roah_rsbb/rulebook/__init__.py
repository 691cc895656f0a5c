"""Reads and checks the configuration files: benchmarks, schedule, passwords. Errors name the file and the line."""
