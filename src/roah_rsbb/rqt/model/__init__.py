"""What the panels of a process share: what the core published, the zone, calls. No widgets."""
