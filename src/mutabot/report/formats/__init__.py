"""Formats of reports: one file each, with a function ``make``."""
