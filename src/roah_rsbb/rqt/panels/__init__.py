"""The panels, and the parts of them."""
