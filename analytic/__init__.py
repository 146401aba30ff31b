"""The vector-equation core: dyads in closed form, exact velocities and accelerations, kinetostatics."""

from .change_points import check_way
from .compiled import fast_solver
from .decomposition import route
from .derivatives import derivatives
from .inverse import inverse
from .many import Machines, many_solver, solve_many
from .solve import solve, solver
from .streams import Extremes, Grid, Histogram, Integral, reduce_many

__all__ = [
    "Extremes",
    "Grid",
    "Histogram",
    "Integral",
    "Machines",
    "check_way",
    "derivatives",
    "fast_solver",
    "inverse",
    "many_solver",
    "reduce_many",
    "route",
    "solve",
    "solve_many",
    "solver",
]
