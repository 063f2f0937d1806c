"""What can be read at the ends of tests, and what is read there."""
