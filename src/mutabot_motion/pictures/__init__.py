"""Videos of original and mutant side by side: filmed, or drawn."""
