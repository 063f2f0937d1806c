"""The visual model: the cell's bodies with visual shapes, posed as the simulation is.

It is another model than the one that is simulated, so that nothing of it can touch, weigh or cost anything
there. Only a picture builds it.
"""

from __future__ import annotations

import mujoco
import numpy as np

from mutabot_cell.models.assembly import cell_spec
from mutabot_cell.models.gripping import PREFIX as TOOL_PREFIX
from mutabot_cell.models.options import compile_quietly
from mutabot_cell.simulation import Simulation

from .arm import dress_gen3
from .cartons import dress_part
from .conveyor import Seam, dress_belt
from .files import dress_from_file
from .furniture import dress_barrier, dress_pedestal, dress_table
from .gripper import Linkage, dress_2f85
from .studio import add_lights
from .style import HIDDEN, add_materials, is_added


class VisualModel:
    """The model and pose for pictures of one simulation.

    Attributes:
        model, data: of MuJoCo, for its renderer; posed by `pose`.
        options: what of it is drawn.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self._seams: list[Seam] = []
        self._linkages: list[tuple[str, Linkage]] = []
        self.model = compile_quietly(self._dressed())
        self.data = mujoco.MjData(self.model)
        self.options = mujoco.MjvOption()
        self.options.sitegroup[:] = 0
        self.options.geomgroup[HIDDEN] = 0
        names = [self.model.body(number).name for number in range(self.model.nbody)]
        #: numbers here of the simulated bodies, in their order
        self._bodies = np.array([number for number, name in enumerate(names) if not is_added(name)])

    def pose(self) -> None:
        """Pose everything as it is now in the simulation, also what was moved by changing its model."""
        simulated, state = self._simulation.model, self._simulation.data
        self.model.body_pos[self._bodies] = simulated.body_pos
        self.model.body_quat[self._bodies] = simulated.body_quat
        for prefix, linkage in self._linkages:
            linkage.pose(self.model, self._simulation.robots[prefix].opening())
        for seam in self._seams:
            travel = self._simulation.travels.get(seam.name)
            seam.pose(self.model, travel() if travel is not None else 0.0)
        self.data.qpos[:] = state.qpos
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_camlight(self.model, self.data)

    def _dressed(self) -> mujoco.MjSpec:
        scene, robots = self._simulation.scene, self._simulation.robots
        spec = cell_spec(scene, {prefix: robot.model for prefix, robot in robots.items()})
        add_materials(spec)
        add_lights(spec)
        for fixture in scene.fixtures:
            if fixture.belt is None:
                dress_table(spec, fixture)
            else:
                self._seams.append(dress_belt(spec, fixture))
        for barrier in scene.light_barriers:
            dress_barrier(spec, barrier)
        for part in scene.parts:
            dress_part(spec, part)
        for prefix, robot in robots.items():
            dress_pedestal(spec, prefix, robot.model)
            dress_gen3(spec, prefix)
            dress_from_file(spec, prefix, robot.model.file)
            if robot.model.tool is not None:
                dress_from_file(spec, prefix + TOOL_PREFIX, robot.model.tool.file)
            linkage = dress_2f85(spec, prefix)
            if linkage is not None:
                self._linkages.append((prefix, linkage))
        return spec
