"""Saving the core's state, and continuing from it after a restart."""
