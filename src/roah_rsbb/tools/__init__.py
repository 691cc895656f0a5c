"""Programs for organisers and developers."""
