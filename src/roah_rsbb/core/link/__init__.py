"""A robot's link: freshness of messages, clock skew, quality over time."""
