"""What the core knows of benchmarking modules, and what it exchanges with them."""
