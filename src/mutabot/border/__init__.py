"""What crosses the process border: a job description in, events out."""
