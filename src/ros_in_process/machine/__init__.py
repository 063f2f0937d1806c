"""Threads and time of the simulation, and who sees them."""
