"""What the box and its faces speak of, as plain values: reasons, and what a person may do."""
