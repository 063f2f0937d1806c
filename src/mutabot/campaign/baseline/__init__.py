"""What is known of the original: its tests, their sites and values, and what tests share."""
