"""The referee in a terminal."""
