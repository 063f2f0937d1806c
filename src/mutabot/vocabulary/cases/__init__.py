"""What the meaning of a call depends on: the values of its arguments."""
