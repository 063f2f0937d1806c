"""The engines, which run mutants, with the controls and re-runs that make their outcomes trustworthy."""
