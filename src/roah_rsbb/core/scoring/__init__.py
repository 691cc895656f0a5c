"""Score sheets, their history, and the records of finished runs."""
