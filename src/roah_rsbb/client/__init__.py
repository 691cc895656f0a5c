"""A box from afar: its document, kept current, and calls. What all faces are built on."""
