"""Settings shared by all models of the physics: solver options and collision classes."""

from __future__ import annotations

import warnings

import mujoco

PHYSICS_STEP = 0.002
"""Length of one physics step, s."""

# Collision classes: fixtures (1), arm (2), gripper (4), boxes (8).
DEFAULTS = """
<default>
  <default class="fixture"><geom contype="1" conaffinity="14" friction="1 0.005 0.0001"/></default>
  <default class="arm"><geom contype="2" conaffinity="13"/></default>
  <default class="gripper"><geom contype="4" conaffinity="11"/></default>
  <default class="box"><geom contype="8" conaffinity="15"/></default>
  <default class="looks"><geom contype="0" conaffinity="0" mass="0" group="1"/></default>
</default>
"""

# impratio: friction is ten times as stiff as what presses. With more, boxes held on one edge chatter between
# the pads; with less, they creep.
# The dense Jacobian is right for this size; it also avoids a fault of MuJoCo 4.0.0's sparse factorisation
# (its issue 3767: wrong accelerations; repaired in 4.0.1).
OPTIONS = f"""
<option timestep="{PHYSICS_STEP}" integrator="implicitfast" cone="elliptic" impratio="10" jacobian="dense"
        solver="Newton" iterations="20" tolerance="1e-8">
  <flag autoreset="disable" island="disable"/>
</option>
<compiler angle="radian" autolimits="false"/>
"""

HEAD = OPTIONS + DEFAULTS


def compile_quietly(spec: mujoco.MjSpec) -> mujoco.MjModel:
    """Compile a spec without MuJoCo's warnings about attached parts.

    They are of empty prefixes, with which a model may not be saved correctly (these are not saved), and of
    options of parts, for which those of the cell hold.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return spec.compile()


def _ignore_warning(message: str) -> None:
    """Ignore a warning: models are checked, and `Simulation.tick` detects what matters."""


# here, since every module that builds a model imports this one: MuJoCo writes the first warning into
# MUJOCO_LOG.TXT in the working directory, which building alone can cause
mujoco.set_mju_user_warning(_ignore_warning)
