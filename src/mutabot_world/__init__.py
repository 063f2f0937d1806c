"""Mutations of the simulated world: a parameter is disturbed, and the tests judge the disturbance."""
