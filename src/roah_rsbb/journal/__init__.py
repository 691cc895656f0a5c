"""The durable record: what must outlive the process and the power."""
