"""``mutabot compare``: families of operators side by side."""
