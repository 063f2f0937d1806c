"""Shows a minimal set of the mutants of a campaign: those that no other one subsumes."""
