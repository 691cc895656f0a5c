"""What the tests of the nodes share (test/ros/README.md)."""
