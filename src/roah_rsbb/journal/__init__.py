"""The journal: the durable record of a competition, and reading it."""
