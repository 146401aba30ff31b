"""A family's page: a slider through its members, each with its linkage and numbers; their table, and their curves."""

from collections.abc import Iterator
from dataclasses import dataclass

from scenes import Sampling

from ...engines.axis import axis
from ...family.family import Family
from ...judge.agreement import Agreement
from .. import first_screen
from ..html import render
from ..linkage.drawing import Drawing
from ..linkage.svg import by_itself
from ..units import units
from . import tables
from .figure import MOST_LINES, curves, drawn

DRAWN = Sampling(144)  # of the linkages
FRAMES = 36  # poses of each


@dataclass(frozen=True)
class Shown:
    """One member as the slider shows it."""

    label: str
    row: int  # in the table of members
    agreement: Agreement
    svg: str
    ends: tuple[float, float]  # of the motion on the axis, SI
    peaks: list[first_screen.Shown]
    joints: list[first_screen.Shown]


def page(family: Family) -> str:
    """Return the whole report as HTML."""
    able = [member.cycle for member in family.members if member.cycle is not None]
    few = f"{MOST_LINES} of the {len(able)} members that run, evenly chosen." if len(able) > MOST_LINES else ""
    agreement = tables.agreement(family)
    return render(
        "family/family.html",
        family=family,
        tables=tables,
        agreement=agreement,
        mark=first_screen.MARKS[agreement.word],
        marks=first_screen.MARKS,
        shown=[*_shown(family)],
        able=able,
        slides=any("displacement" in cycle.curves for cycle in able),
        few=few,
        curves=curves(family) if able else None,
        engines={m.run.engine: m.run.version for f in family.members for m in f.measurements},
    )


def _shown(family: Family) -> Iterator[Shown]:
    """Yield the members that are drawn, all at one scale and with the same units."""
    chosen = [(member, cycle, member.judgement) for member, cycle in drawn(family) if member.judgement is not None]
    judged = [judgement for _, _, judgement in chosen]
    alone = [Drawing(j.scene, j.reference.at(DRAWN.commanded(j.scene), DRAWN.times(j.scene))) for j in judged]
    named = units(*(j.reference for j in judged)) if judged else {}
    for (member, cycle, judgement), own in zip(chosen, alone, strict=True):
        over = own.motion[axis(own.scene).channel]
        drawing = Drawing(own.scene, own.motion, [other for other in alone if other is not own])
        yield Shown(
            tables.label(family, member),
            next(row for row, other in enumerate(family.members) if other is member),
            judgement.agreement,
            by_itself(drawing, FRAMES),
            (float(over[0]), float(over[-1])),
            first_screen.peaks(own.scene, cycle.peaks, named),
            first_screen.joints(own.scene, cycle.peaks, named),
        )
