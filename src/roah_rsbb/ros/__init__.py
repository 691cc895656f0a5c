"""What all nodes share: parameters, the loop, times, refused calls, the command line."""
