"""The report of a competition: statistics of its runs, as a folder of pages."""
