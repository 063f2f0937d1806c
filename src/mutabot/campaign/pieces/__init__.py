"""What Python files are made of, and what a test can reach of it under any mutant."""
