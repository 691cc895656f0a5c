"""Programs with windows: the list of panels, rqt plugins, our own window."""
