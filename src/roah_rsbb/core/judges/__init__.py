"""Several judges with a sheet each, the settlement of their differences, and objections to the result."""
