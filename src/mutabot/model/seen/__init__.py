"""What was seen of a mutant at work: what tests checked, and how its world went another way."""
