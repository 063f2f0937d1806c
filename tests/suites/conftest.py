"""The projects of the corpus are data: their tests run in copies, never as tests of this project."""

collect_ignore = ["projects"]
