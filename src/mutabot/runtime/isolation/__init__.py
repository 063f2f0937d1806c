"""Processes that continue from the state of another: forks for mutants, copies of a session."""
