"""Support for the tests of the nodes (test/ros/README.md)."""
