"""Faults of the simulated world: parameters of it are disturbed, and the tests judge that."""
