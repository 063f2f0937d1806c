"""What the headers of messages say wrongly, one operator to a file."""
