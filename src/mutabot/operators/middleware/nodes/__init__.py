"""What befalls nodes, services and actions, one operator to a file."""
