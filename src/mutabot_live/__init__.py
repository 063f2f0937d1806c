"""The report of a campaign that runs, served to browsers on this machine, with pause and stop."""
