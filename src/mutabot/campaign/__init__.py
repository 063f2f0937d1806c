"""The controller: baseline, plan, engines, journal. It never imports the robot program."""
