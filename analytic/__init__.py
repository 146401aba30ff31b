"""The vector-equation core: dyads in closed form, exact velocities and accelerations, kinetostatics."""

from .decomposition import route
from .inverse import inverse
from .solve import solve, solver

__all__ = ["inverse", "route", "solve", "solver"]
