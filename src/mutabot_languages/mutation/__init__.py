"""Mutants of a program's text: differences of a line, planned from the text and active when it is loaded."""
