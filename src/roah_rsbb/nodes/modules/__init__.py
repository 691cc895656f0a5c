"""Node roah_rsbb_modules, and the ground truth that it measures robots against."""
