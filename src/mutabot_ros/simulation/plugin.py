"""A pytest plug-in that runs the suite over simulated ROS as a campaign does.

`MUTABOT_ROUND=3 python -m pytest -p mutabot_ros.simulation.plugin` repeats the orders of a campaign's round.
"""

from .settings import configure

pytest_plugins = ["ros_in_process.plugin"]

configure()
