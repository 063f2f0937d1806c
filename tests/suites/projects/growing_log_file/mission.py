"""Every cell of the shop writes into one log."""

import logging


def make_logger(path):
    logger = logging.getLogger(f"cell-{path}")
    logger.setLevel(logging.INFO)
    logger.addHandler(logging.FileHandler(path))
    return logger


def deliver(agv, logger):
    agv.drive(4.0)
    logger.info("at %.1f", agv.odometer())
    agv.drive(2.5)
    logger.info("at %.1f", agv.odometer())
    agv.horn(True)
    logger.info("horn %s", agv.honked)
