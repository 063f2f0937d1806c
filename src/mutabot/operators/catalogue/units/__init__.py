"""Numbers that are taken for another unit, one operator to a file."""
