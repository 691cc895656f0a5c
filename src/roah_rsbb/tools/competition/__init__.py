"""Creates a competition's folder from a few answers or a CSV sheet, and checks it (docs/organiser.md).

This package knows the organiser's decisions (teams, zones, benchmarks, days) and writes the files that the box reads.
The format of these files belongs to the rulebook and the benchmarking modules. No ROS.
"""
