"""How ``mutabot init`` tells a run of the tests what to watch."""

#: names the file with what to watch: program, tests, output
WATCH_VARIABLE = "MUTABOT_WATCH"
