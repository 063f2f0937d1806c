"""From what was read to the fewest checks that notice most."""
