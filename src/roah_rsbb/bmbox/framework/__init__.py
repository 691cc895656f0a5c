"""What all benchmarking modules share: rules as coroutines, parameters, scores, ground truth."""
