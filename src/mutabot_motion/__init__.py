"""Shows the motions of original and mutant: one file per format or viewer."""
