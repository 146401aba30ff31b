"""The page on many linkages of one scene: a family's with a slider through its members, or that of tolerances."""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from scenes import Failure, Motion, Sampling, Scene, load

from ...engines import registry
from ...judge.agreement import Agreement
from ...judge.measure import Measurement
from ...measure.many.family import Family
from ...measure.many.study import MonteCarlo
from ...mechanics.axis import axis
from ..figures.family import MOST_LINES, curves, drawn
from ..figures.monte_carlo import histograms, variance_shares
from ..linkage.drawing import Drawing
from ..linkage.svg import by_itself
from ..numbers import units
from ..tables import family as family_tables
from ..tables import monte_carlo as monte_carlo_tables
from ..tables.first_screen import Answer, answers
from .html import render

DRAWN, FRAMES = Sampling(144), 36  # samples and poses of a drawing


class ShownMember(NamedTuple):
    """One member as the slider shows it."""

    label: str
    row: int  # in the table of members
    agreement: Agreement
    svg: str
    ends: tuple[float, float]  # of the motion on the axis, SI
    answers: tuple[list[Answer], list[Answer]]


def family_page(family: Family) -> str:
    """The whole report on a family as HTML."""
    able = [member.cycle for member in family.members if member.cycle is not None]
    return _page(
        "family.html",
        family,
        [m for member in family.members for m in member.measurements],
        agreement=family_tables.agreement(family),
        tables=family_tables,
        shown=[*_shown(family)],
        able=able,
        slides=any("displacement" in cycle.curves for cycle in able),
        most_lines=MOST_LINES,
        curves=curves(family) if able else None,
    )


def monte_carlo_page(study: MonteCarlo) -> str:
    """The whole report on tolerances as HTML."""
    moving = monte_carlo_tables.moving(study)
    return _page(
        "monte_carlo.html",
        study,
        study.judged.measurements,
        agreement=study.judged.agreement,
        tables=monte_carlo_tables,
        histograms=histograms(study) if moving else None,
        shares=variance_shares(study) if moving else None,
        drawing=_worst(study),
    )


def _page(template: str, many: Family | MonteCarlo, runs: Sequence[Measurement], **values: Any) -> str:
    return render(template, many=many, engines={m.run.engine: m.run.version for m in runs}, **values)


def _motion(scene: Scene) -> Motion:
    return registry.reference(scene)(DRAWN.commanded(scene), DRAWN.times(scene))


def _shown(family: Family) -> Iterator[ShownMember]:
    """Yield the members that are drawn, all at one scale and with the same units."""
    chosen = [(member, cycle, member.judgement) for member, cycle in drawn(family) if member.judgement is not None]
    alone = [Drawing(judged.scene, _motion(judged.scene)) for _, _, judged in chosen]
    named = units(*(judged.reference for _, _, judged in chosen)) if chosen else {}
    for (member, cycle, judged), own in zip(chosen, alone, strict=True):
        over = own.motion[axis(own.scene).channel]
        drawing = Drawing(own.scene, own.motion, [other for other in alone if other is not own])
        yield ShownMember(
            family_tables.label(family, member),
            next(row for row, other in enumerate(family.members) if other is member),
            judged.agreement,
            by_itself(drawing, FRAMES),
            (float(over[0]), float(over[-1])),
            answers(own.scene, cycle.peaks, named),
        )


def _worst(study: MonteCarlo) -> str:
    """The worst machine moving; nothing where all are alike, or it locks where nobody looked before."""
    if study.worst is None:
        return ""
    scene = load(study.scene.file, study.changes(study.worst[0]))
    try:
        return by_itself(Drawing(scene, _motion(scene)), FRAMES)
    except Failure:
        return ""
