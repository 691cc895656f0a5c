"""What the files of a competition may say: benchmarks, schedule, passwords. Errors name file and line."""
