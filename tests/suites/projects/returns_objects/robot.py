from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Pose:
    x: float
    y: float


class Arm:
    def __init__(self):
        self.pose = Pose(0.0, 0.0)
        self.tool_on = False
        self.visited = []

    def move(self, pose):
        self.pose = pose
        self.visited.append(pose)
        return self.pose

    def scan(self, step):
        poses = []
        for _ in range(2):
            self.pose = replace(self.pose, y=round(self.pose.y + step, 6))
            poses.append(self.pose)
        return poses

    def tool(self, on):
        self.tool_on = on

    def where(self):
        return self.pose
