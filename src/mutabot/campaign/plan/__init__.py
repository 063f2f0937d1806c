"""Which mutants there are, and which of them to run."""
