"""Sentences about survivors, and what a simulation that mutabot does not watch says of them."""
