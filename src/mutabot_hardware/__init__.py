"""Campaigns on hardware: guards before every command, one mutant at a time, a stop at surprises."""
