"""Reports: one file per format, which only reads the journal."""
