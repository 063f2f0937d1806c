"""Pages that a browser opens from disk: ``folder.py`` writes them, and what is in ``assets/`` shows them."""
