"""Readings that mutabot takes itself: probes, the clock, the objects they belong to."""
