"""What mutabot is told of a cell in MuJoCo while it records."""

from functools import partial

import mujoco
import numpy as np

from mutabot.api.processes import Feed


def tell(model, data, *, tool, things, arm=(), width=480, height=360):
    """A feed of this cell: call its `tick` after each `mj_step`.

    tool: name of the site at the tool's tip; things: names of bodies, with the edge lengths of their boxes;
    arm: names of the arm's bodies from its base to its tool, by which reports draw it.
    """
    feed, renderers, quaternion = Feed(lambda: data.time), [], np.zeros(4)

    def pose_of_tool():
        site = data.site(tool)
        mujoco.mju_mat2Quat(quaternion, site.xmat)
        return [*site.xpos, *quaternion]

    def picture():
        if not renderers:
            renderers.append(mujoco.Renderer(model, height, width))
        renderers[0].update_scene(data)
        return renderers[0].render()

    def touching():
        for contact in data.contact[: data.ncon]:
            names = [model.body(model.geom_bodyid[geom]).name for geom in contact.geom]
            if names[0] != names[1]:
                yield tuple(names)

    def joints():
        return data.xpos[[model.body(name).id for name in arm]].ravel()

    def pose_of(body):
        return [*body.xpos, *body.xquat]

    feed.pose("tool", pose_of_tool)
    for name, size in things.items():
        feed.pose(name, partial(pose_of, data.body(name)), size=size)
    if arm:
        feed.line("arm", joints, radii=[0.05] * len(arm))
    feed.contacts(touching)
    feed.camera(picture, rate=12)
    return feed
