"""What differs between two campaigns: as text, as JSON and as Markdown."""
