"""The operators of the family ``robot``: those that are published."""
