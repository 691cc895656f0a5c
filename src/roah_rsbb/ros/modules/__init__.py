"""Node roah_rsbb_modules, and its ground truth."""
