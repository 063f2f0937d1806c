"""pytest at work for a job: which tests run, how they end, and what plug-ins may do."""
