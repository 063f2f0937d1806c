"""Graded faults: what a round says of them, and what users demand."""
