"""Thresholds: the largest graded faults that the tests miss, and what users demand of them."""
