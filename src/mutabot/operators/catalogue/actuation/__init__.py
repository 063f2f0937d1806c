"""Commands that are carried out too weakly, too strongly or not fully, one operator to a file."""
