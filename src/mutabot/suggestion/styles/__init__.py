"""Styles of tests, one file each: where a check can be added to a test, and what it looks like there."""
