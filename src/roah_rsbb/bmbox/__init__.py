"""Benchmarking modules: one file of rules for each functionality benchmark, and what they share.

No ROS, no clock, no robot: a module asks, `runner` passes it on. How to write one: docs/write_a_benchmark.md.
"""
