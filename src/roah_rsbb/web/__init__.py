"""The gateway for browsers: pages and live data, fed with the box's document. No ROS (docs/web.md)."""
