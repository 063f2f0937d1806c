"""What a user writes in TOML files, read and checked: the configuration; and mistakes in his words."""
