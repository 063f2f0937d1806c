"""The HTML report, which a browser opens from disk: pages, their data and their assets."""
