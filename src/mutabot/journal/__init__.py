"""The journal of a campaign: one SQLite file, which can be read without the controller."""
