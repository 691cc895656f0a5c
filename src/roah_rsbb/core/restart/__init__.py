"""What a restarted core continues from."""
