"""Let the virtual environment that runs this see Debian's rospy, if it is installed and fits.

Debian keeps rospy among the modules of its own Python. A virtual environment that saw them all would also
find pytest plug-ins there, and other versions of what it has itself. So it sees a folder with links to ROS's
modules only, behind everything else.

    python tools/see_rospy.py        # says what it did; never fails
"""

from __future__ import annotations

import subprocess
import sys
import sysconfig
from pathlib import Path

DEBIAN = Path("/usr/lib/python3/dist-packages")
#: ROS 1 itself
ROS = (
    "actionlib", "catkin", "catkin_pkg", "genmsg", "genpy", "message_filters", "roscpp", "rosclean",
    "rosgraph", "roslaunch", "roslib", "rosmaster", "rosparam", "rospkg", "rospy", "rostest", "rosunit",
    "tf2_py", "tf2_ros",
)  # fmt: skip
#: what it imports and a virtual environment need not have
NEEDED = ("_yaml", "dateutil", "defusedxml", "distro", "netifaces", "pyparsing", "yaml")
#: packages of messages and services
KINDS = ("_msgs", "_srvs")


def main() -> None:
    """Make the links, or say why there are none."""
    if sys.prefix == sys.base_prefix:
        print("rospy: this is no virtual environment, so nothing is done")
        return
    place = Path(sys.prefix, "ros1")
    path_file = Path(sysconfig.get_path("purelib"), "ros1.pth")
    why_not = reason()
    if why_not is not None:
        path_file.unlink(missing_ok=True)
        print(f"rospy: {why_not}; tests with ROS 1 skip themselves")
        return
    place.mkdir(exist_ok=True)
    for old in place.iterdir():
        old.unlink()
    for module in modules(DEBIAN):
        (place / module.name).symlink_to(module)
    path_file.write_text(f"{place}\n", encoding="utf-8")


def reason() -> str | None:
    """Why Debian's rospy cannot be used here; None if it can."""
    if not (DEBIAN / "rospy").is_dir():
        return f"not in {DEBIAN} (Debian's package python3-rospy)"
    python = Path("/usr/bin/python3")
    if not python.exists():
        return f"there is no {python}"
    asked = [str(python), "-c", "import sys; print('%d.%d' % sys.version_info[:2])"]
    version = subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip()
    own = "{}.{}".format(*sys.version_info[:2])
    return None if version == own else f"it is for Debian's Python {version}, this is {own}"


def modules(place: Path) -> list[Path]:
    """ROS's modules in a folder, and those that it needs."""
    wanted = {*ROS, *NEEDED}
    return sorted(
        path
        for path in place.iterdir()
        if not path.name.endswith("-info")
        and (path.name.partition(".")[0] in wanted or path.name.endswith(KINDS))
    )


if __name__ == "__main__":
    main()
