"""What sensors and their drivers do wrong, one operator to a file."""
