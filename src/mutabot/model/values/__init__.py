"""What arguments and results mean, and the values they have."""
