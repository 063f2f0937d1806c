"""Suggests checks that kill survivors, proven by running them."""
