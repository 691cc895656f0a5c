"""What everything stands on: the operating system, durable files, parameters, the command line, loops."""
