"""The one wording of scores, score sheets, runs, times and units. Imports the standard library only."""
