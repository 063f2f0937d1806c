"""What original and mutant did, to be looked at: one file per format or viewer."""
