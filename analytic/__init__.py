"""The vector-equation core: dyads in closed form, exact velocities and accelerations, kinetostatics."""

from .change_points import check_way
from .decomposition import route
from .inverse import inverse
from .solve import solve, solver

__all__ = ["check_way", "inverse", "route", "solve", "solver"]
