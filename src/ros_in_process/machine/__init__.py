"""Threads and time of the simulation, and the modules that see them."""
