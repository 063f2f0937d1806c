"""Readings by mutabot itself: probes, the clock, checks, and the objects that they belong to."""
