"""Equilibrium paths of structures with unilateral contact and Coulomb friction: models, jobs and paths of arcslip.

>>> import arcslip
>>> model = arcslip.Model(2)
>>> model.node("block", 0, 0)
'block'
>>> model.spring("block", stiffness=[[2, 0], [0, 0]])
0
>>> model.plane("floor", point=[0, 0], normal=[0, 1])
'floor'
>>> model.contact("block", "floor", friction=0.3)
0
>>> model.stage("press", forces={"block": [0, -1]}, until={"load_above": 1})
'press'
>>> len(model.request()["model"]["stages"])
1

`solve` runs the program `arcslip`; `Client` talks to a running service. Both give a `Path`.
"""

from arcslip.client import Client, Curve, Job, Study, Sweep
from arcslip.errors import (
    ArcslipError, InvalidModel, JobFailed, Mistake, ModelWarning, ProgramFailed, ProgramNotFound, Refused, Unreachable,
)
from arcslip.model import Model
from arcslip.path import Path
from arcslip.program import find_program, scene, solve

__all__ = [
    "ArcslipError", "Client", "Curve", "InvalidModel", "Job", "JobFailed", "Mistake", "Model", "ModelWarning", "Path",
    "ProgramFailed", "ProgramNotFound", "Refused", "Study", "Sweep", "Unreachable", "__version__", "find_program", "scene", "solve",
]

#: The version of the package.
__version__ = "0.1.0"
