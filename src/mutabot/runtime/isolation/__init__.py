"""Processes that begin where another one stands: branches of a trunk, copies of a session."""
