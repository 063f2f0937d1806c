"""Patches as mutants: each unified diff of a folder, such as a fix that was reverted, is a fault."""
