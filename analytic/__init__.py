"""The vector-equation core: dyads in closed form, exact velocities and accelerations, kinetostatics."""

from .core.decomposition import in_closed_form, route
from .proven.assemblies import assemblies
from .proven.enclosures import departures, enclose
from .recorded.derivatives import derivative_solver, derivatives
from .recorded.fast import fast_solver
from .recorded.many import Machines, many_solver, solve_many
from .recorded.page import page_program
from .recorded.streams import Extremes, Grid, Histogram, Integral, reduce_many
from .solve import solve, solver
from .way.change_points import check_way
from .way.sketched import sketch_fit
from .way.slider import inverse
from .way.stopped import stopped

__all__ = ["Extremes", "Grid", "Histogram", "Integral", "Machines", "assemblies", "check_way", "departures"]
__all__ += ["derivative_solver", "derivatives", "enclose", "fast_solver", "in_closed_form", "inverse", "many_solver"]
__all__ += ["page_program", "reduce_many", "route", "sketch_fit", "solve", "solve_many", "solver", "stopped"]
