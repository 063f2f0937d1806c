import logging

log = logging.getLogger("mission")


def inspect_box(camera, arm):
    arm.down(0.2)
    colour = camera.colour()
    print(f"box is {colour}")
    if colour == "blue":
        log.warning("blue box at %.2f m", arm.height())
    arm.down(-0.2)
    log.info("done")
