"""Thresholds: how large a graded fault the tests miss, from its magnitudes to what users demand."""
