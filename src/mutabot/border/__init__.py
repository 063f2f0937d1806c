"""What crosses the process border: a job description in, report lines out."""
