"""Commands that list what there is, whatever the project."""
