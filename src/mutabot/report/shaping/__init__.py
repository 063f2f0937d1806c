"""What formats share: texts that can go anywhere, places in files, and one state per mutant."""
