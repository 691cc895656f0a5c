"""Parts of the system that a test plays in its own process."""
