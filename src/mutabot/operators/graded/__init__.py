"""Graded operators: faults with a magnitude, in the unit of what they change, on a ladder."""
