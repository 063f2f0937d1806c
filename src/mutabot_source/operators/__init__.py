"""The operators on program text, one file each."""
