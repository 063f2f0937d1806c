"""Interception of calls of operations: find them, read them, mutate them, and record them."""
