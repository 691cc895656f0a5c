"""Benchmarking modules: one file of rules per functionality benchmark, and the framework that they share.

There is no ROS and no clock here. A module makes requests, which `framework/runner.py` passes on. How to write a
module: docs/write_a_benchmark.md.
"""
