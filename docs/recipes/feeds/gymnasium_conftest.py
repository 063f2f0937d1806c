"""The environment, and what mutabot is told of it while it records."""

import gymnasium
import metaworld  # noqa: F401  # registers its environments
import pytest

from mutabot.api.processes import Feed


class Told(gymnasium.Wrapper):
    """Tells mutabot where hand and puck are, after each step."""

    def __init__(self, env):
        super().__init__(env)
        inner = env.unwrapped
        self.feed = feed = Feed(lambda: inner.data.time)
        feed.point("hand", lambda: inner.data.body("hand").xpos)
        feed.point("puck", lambda: inner.data.body("obj").xpos, size=(0.04, 0.04, 0.04))
        feed.camera(lambda: env.render()[::-1], rate=10)  # this camera stands on its head

    def step(self, action):
        found = super().step(action)
        self.feed.tick()
        return found


@pytest.fixture(scope="module")
def env():
    env = gymnasium.make(
        "Meta-World/MT1", env_name="pick-place-v3", seed=7, render_mode="rgb_array", camera_name="corner"
    )
    yield Told(env)
    env.close()
