"""The report as a folder of pages that a browser opens from disk: ``folder.py`` writes it, ``assets/`` shows it."""
