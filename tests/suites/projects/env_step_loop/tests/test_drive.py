import mission
from robot import CartEnv


def test_reaches_the_goal():
    env = CartEnv()
    total, info = mission.drive(env)
    assert env.position >= 1.0


def test_takes_ten_steps():
    env = CartEnv()
    total, info = mission.drive(env)
    assert info["steps"] == 10


def test_a_second_episode_starts_anew():
    env = CartEnv()
    mission.drive(env)
    total, _ = mission.drive(env)
    assert round(total, 6) == 0.1
