"""What the cell tells mutabot of itself while a test is recorded."""
