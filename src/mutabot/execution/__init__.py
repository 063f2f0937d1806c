"""Processes that run jobs, as many at a time as they may."""
