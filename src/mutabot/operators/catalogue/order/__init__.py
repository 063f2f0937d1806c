"""Commands in the wrong order, at the wrong time, or not once, one operator to a file."""
