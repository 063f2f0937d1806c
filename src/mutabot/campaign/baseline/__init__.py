"""The baseline: the original's tests, the sites and values that they reach, and what tests share."""
