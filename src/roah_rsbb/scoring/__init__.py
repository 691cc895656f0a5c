"""What a run is worth: sheets, points, judges, what counts. Pure: shared by the box and the results."""
