"""Patches as mutants: each unified diff in a folder, such as a reverted fix, is a fault."""
