"""Thresholds on the terminal, as JSON and as a picture."""
