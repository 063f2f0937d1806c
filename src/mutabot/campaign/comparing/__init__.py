"""How far a mutant's test ended from the original's: traces, probes, what the program returned."""
