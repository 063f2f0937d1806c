"""What a test shares with others: fixtures, state of the process, files."""
