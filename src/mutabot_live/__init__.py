"""The report of a campaign that runs, served to browsers on this machine, with a button to stop."""
