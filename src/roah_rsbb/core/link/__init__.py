"""What is known of a robot's link: freshness, clock skew, quality over time."""
