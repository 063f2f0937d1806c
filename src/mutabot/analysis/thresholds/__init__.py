"""Thresholds: how big a graded fault must be before the tests notice, and what that says."""
