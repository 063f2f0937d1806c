"""Processes that begin where another one stands: forks for mutants, copies of a session."""
