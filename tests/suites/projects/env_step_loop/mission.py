"""A policy that drives a cart to its goal."""


def drive(env, steps=20):
    position, _ = env.reset()
    total = 0.0
    for _ in range(steps):
        action = 0.1 if position < 0.95 else 0.0
        position, reward, done, info = env.step(action)
        total += reward
        if done:
            break
    return total, info
