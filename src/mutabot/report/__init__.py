"""Reports: one file per format. They only read the journal."""
