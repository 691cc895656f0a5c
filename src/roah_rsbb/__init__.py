"""RoAH RSBB: the Referee, Scoring and Benchmarking Box of a home-robot competition."""
