"""The one wording of scores, sheets, times and units."""
