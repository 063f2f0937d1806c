"""The journal of a campaign: one SQLite file. Reading it needs nothing of the controller."""
