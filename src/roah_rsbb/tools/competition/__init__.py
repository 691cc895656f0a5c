"""A competition's directory: made from a few answers or a CSV sheet, and checked (docs/organiser.md).

It knows what an organiser decides (teams, zones, benchmarks, days) and writes the files that the box reads; what
these files may say is the core's knowledge, and the benchmarking modules'. No ROS.
"""
