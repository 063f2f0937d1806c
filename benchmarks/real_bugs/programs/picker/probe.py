"""What the program does with an input drawn at random."""

from robot import Arm, Camera, Gripper


def observe(program, draw):
    arm, part = Arm(), draw.choice([None, [draw.uniform(-1, 1), draw.uniform(-1, 1)]])
    gripper, camera = Gripper(arm, draw.choice([part, part, [0.3, 0.3]])), Camera(arm, part)
    picker = program.Picker(arm, gripper, camera)
    found = []
    for _ in range(draw.randint(1, 3)):
        found.append((picker.run(draw.random() < 0.5), picker.failed, gripper.force, gripper.closed))
        if draw.random() < 0.5 and part is not None:
            picker.pick(part, draw.random() < 0.5)
            found.append((picker.may_idle(), gripper.force, gripper.held))
        found.append((list(arm.position), picker.may_idle()))
        gripper.part = part
    return found, picker.driven, arm.log
