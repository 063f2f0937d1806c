"""Reports on results: terminal, pages, and one file for each other format."""
