"""Programs with windows: the list of panels, our own window, single panels."""
