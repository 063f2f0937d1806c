DEFAULTS = {"speed": 0.2, "blend": 0.0}


def pack(arm, offsets):
    for offset in offsets:
        arm.line(*offset, **DEFAULTS)
    arm.line(dz=0.3, dx=0.0)
    options = {"on": True}
    arm.vacuum(**options)
    arm.vacuum(on=len(offsets) < 2)
