"""Reports in formats of other tools: one file each, with a function ``make``."""
