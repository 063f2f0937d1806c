"""The catalogue of mistakes that robot programs are known for, and faults of messages on a middleware."""
