"""The pages of teams: their codes, and what they ask."""
