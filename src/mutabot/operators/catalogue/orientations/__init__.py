"""Orientations as a whole that are written or read in another way, one operator to a file."""
