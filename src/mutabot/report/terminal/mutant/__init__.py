"""Everything about one mutant on the terminal, section by section."""
