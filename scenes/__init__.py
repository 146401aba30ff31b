"""What every model shares: the scene, what a model must return, and the scene files.

| word | meaning in the whole repository |
|---|---|
| Assur group | the fewest bodies that have no freedom left once they hang on what is placed: solved together |
| dyad | an Assur group of two bodies, class II, solved in closed form; a larger group is solved by Newton's method |
| branch, assembly mode | one of the ways to put the same bodies together at one position of the drive |
| singular configuration, locking pose | a pose in which a group's Jacobian is singular: two branches meet |
| change point | a singular configuration that the drive can go through, from either branch into the other |
| dead point | a pose in which a slider stands still while the drive moves on |
| transmission angle | at a dyad's inner joint, how far from singular it is: 0 there, a right angle at best |
| `to_lock` | how far from singular a group is: by how much its nearest length would have to be off |
| kinetostatics | the forces at the joints and of the drive that a known motion asks for |
| constraint residual | by how much the joints of a pose are open |
| condition | by how much a small relative error of what goes in is larger in what comes out |
| round-off | what doubles cost: their last place, 2.2e-16, times the condition |
| floor | how far the reference itself may be off, measured against 50 digits; no error below it is shown |
| promise | the largest relative error at which an engine's run may end `ok` |
| silent | of a run whose broken promise the reference alone shows, and no check without one |
| work-precision | time against error, over an engine's settings from cheap to accurate |
| inputs | what a model is solved at: instants, and the drives' positions, rates and accelerations there |
| request | the instants, positions of the drive or inputs, and the channels that a model is asked for |
| channel, sample | one column of a motion, as `P5.y`, and one row, at one instant; a step is an engine's own |
| ladder, rung | a hard case: a scene with one number that gets harder from rung to rung |
"""

from .errors import InputError
from .file.reader import from_tables, load, numbers_in, shipped, with_changes, write_starter
from .model.engine import Engine, Failure, ProcessorBudget, Settings, Simulation, Status
from .model.inputs import Inputs
from .model.motion import AtInputs, Instants, Motion, Positions, Request, Rows, Sampling
from .scene import Scene

__all__ = [
    "AtInputs",
    "Engine",
    "Failure",
    "InputError",
    "Inputs",
    "Instants",
    "Motion",
    "Positions",
    "ProcessorBudget",
]
__all__ += ["Request", "Rows", "Sampling", "Scene", "Settings", "Simulation", "Status"]
__all__ += ["from_tables", "load", "numbers_in", "shipped", "with_changes", "write_starter"]
