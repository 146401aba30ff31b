"""The vector-equation core: dyads in closed form, exact velocities and accelerations, kinetostatics."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from .core.decomposition import in_closed_form, route
from .proven.enclosures import departures, enclose
from .recorded.page import page_program
from .solve import solve, solver
from .way.change_points import check_way
from .way.sketched import sketch_fit

if TYPE_CHECKING:
    from .proven.assemblies import assemblies
    from .recorded.derivatives import derivative_solver, derivatives
    from .recorded.fast import fast_solver
    from .recorded.many import Machines, many_solver, solve_many
    from .recorded.streams import Extremes, Grid, Histogram, Integral, reduce_many
    from .way.slider import inverse
    from .way.stopped import stopped

__all__ = ["Extremes", "Grid", "Histogram", "Integral", "Machines", "assemblies", "check_way", "departures"]
__all__ += ["derivative_solver", "derivatives", "enclose", "fast_solver", "in_closed_form", "inverse", "many_solver"]
__all__ += ["page_program", "reduce_many", "route", "sketch_fit", "solve", "solve_many", "solver", "stopped"]

# What a report needs none of is imported when it is asked for: by module, the names of the imports above.
LATE = {
    "proven.assemblies": ("assemblies",),
    "recorded.derivatives": ("derivative_solver", "derivatives"),
    "recorded.fast": ("fast_solver",),
    "recorded.many": ("Machines", "many_solver", "solve_many"),
    "recorded.streams": ("Extremes", "Grid", "Histogram", "Integral", "reduce_many"),
    "way.slider": ("inverse",),
    "way.stopped": ("stopped",),
}


def __getattr__(name: str) -> Any:
    """What is imported late."""
    for module, names in LATE.items():
        if name in names:
            return getattr(import_module(f"{__name__}.{module}"), name)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
