"""The core's side of benchmarking modules: messages, presence, requests."""
