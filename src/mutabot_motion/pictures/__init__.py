"""Videos of original and mutant beside each other: filmed, or drawn."""
