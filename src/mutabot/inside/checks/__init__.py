"""What the tests check: which values their checks compare, and by how much each of them holds."""
