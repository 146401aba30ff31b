"""What every model shares: the scene, what a model must return, and the scene files."""

from .engine import Engine, Failure, Settings, Simulation, Status
from .errors import InputError
from .motion import Motion
from .reader import LIBRARY, load, numbers_in, shipped
from .request import Positions, Request, Sampling
from .scene import Scene
from .starter import write_starter

__all__ = [
    "LIBRARY",
    "Engine",
    "Failure",
    "InputError",
    "Motion",
    "Positions",
    "Request",
    "Sampling",
    "Scene",
    "Settings",
    "Simulation",
    "Status",
    "load",
    "numbers_in",
    "shipped",
    "write_starter",
]
