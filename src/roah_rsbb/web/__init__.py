"""The gateway for browsers: pages and live data, fed with the core's public topics. No ROS (docs/web.md)."""
