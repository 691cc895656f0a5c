"""Node roah_rsbb_core."""
