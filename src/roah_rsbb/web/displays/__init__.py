"""The displays: their list, and what the organiser sets for them."""
