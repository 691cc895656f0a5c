"""What the panels of a process share: the core's messages, the zone, calls, the client."""
