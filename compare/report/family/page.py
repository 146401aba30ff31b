"""A family's page: the table of its members, and their curves over one cycle."""

from ...family.family import Family
from ..html import render
from . import tables
from .figure import MOST_LINES, curves


def page(family: Family) -> str:
    """Return the whole report as HTML."""
    able = [member.cycle for member in family.members if member.cycle is not None]
    few = f"{MOST_LINES} of the {len(able)} members that run, evenly chosen." if len(able) > MOST_LINES else ""
    return render(
        "family/family.html",
        family=family,
        tables=tables,
        able=able,
        slides=any("displacement" in cycle.curves for cycle in able),
        few=few,
        curves=curves(family) if able else None,
        engines={m.run.engine: m.run.version for f in family.members for m in f.measurements},
    )
