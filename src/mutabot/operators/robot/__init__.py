"""The operators of the family ``robot``, one file each."""
