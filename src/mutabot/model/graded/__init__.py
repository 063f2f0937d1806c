"""Graded faults: what users demand of them."""
