import gymnasium
import metaworld  # noqa: F401  # registers its environments
import numpy as np
import pytest

import carry


@pytest.fixture(scope="module")
def env():
    env = gymnasium.make("Meta-World/MT1", env_name="pick-place-v3", seed=7)
    yield env
    env.close()


def test_the_puck_is_carried_to_the_goal(env):
    observation, _ = env.reset(seed=7)
    goal = env.unwrapped._target_pos
    assert carry.carry(env, observation, goal)
    assert np.linalg.norm(env.unwrapped._get_pos_objects() - goal) < 0.08


def test_a_goal_out_of_reach_is_not_reported_as_reached(env):
    observation, _ = env.reset(seed=7)
    assert not carry.carry(env, observation, np.array([0.0, 0.9, 0.3]), steps=40)
