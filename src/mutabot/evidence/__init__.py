"""Recordings of the world during a test: reported by a simulator, compared, and described for reports.

    from mutabot.api.processes import Feed

    feed = Feed(lambda: data.time)                                  # simulated seconds
    feed.pose("tool", lambda: (*data.site("tool").xpos, *quaternion()))
    feed.pose("box", lambda: (*data.body("box").xpos, *data.body("box").xquat), size=(0.05, 0.05, 0.05))
    feed.contacts(touching_pairs)
    feed.block("table", centre=(0.6, 0.0, 0.95), size=(1.0, 2.5, 0.1))
    feed.camera(picture)                                            # for `mutabot motion MUTANT --video`
    …
    mujoco.mj_step(model, data)
    feed.tick()                                                     # nothing happens outside a campaign

Only what a simulator needs is imported here; it stands on the standard library alone.
"""

from .feed import Feed

__all__ = ["Feed"]
