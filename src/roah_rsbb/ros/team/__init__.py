"""The team's side: the comm node and dummy robots."""
