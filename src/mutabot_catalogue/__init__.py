"""The catalogue of typical mistakes in robot programs, and faults of messages on a middleware."""
