"""Pages on many linkages of one scene: a family, with a slider through its members; tolerances; all assemblies."""

from collections.abc import Iterator
from typing import Any

from scenes import Failure, Sampling, Scene, with_changes
from scenes.model.enclosures import Assemblies

from ...engines import registry
from ...measure.many.family import Family
from ...measure.many.study import MonteCarlo
from ...mechanics.axis import axis
from ..figures.many import MAX_LINES, curves, drawn, histograms, over_number, variance_shares
from ..linkage.drawing import Drawing
from ..linkage.svg import by_itself
from ..numbers import units
from ..tables import family as family_tables
from ..tables import monte_carlo as monte_carlo_tables
from ..tables import proof
from ..tables.first_screen import answers
from .html import render

DRAWN, FRAMES = Sampling(144), 36  # samples and poses of a drawing


def family_page(family: Family) -> str:
    """The whole report on a family as HTML."""
    able = [member.cycle for member in family.members if member.cycle is not None]
    return render(
        "family.html",
        many=family,
        engines={m.run.engine: m.run.version for member in family.members for m in member.measurements},
        agreement=family_tables.agreement(family),
        tables=family_tables,
        shown=[*_shown(family)],
        able=able,
        slides=any("displacement" in cycle.curves for cycle in able),
        most_lines=MAX_LINES,
        curves=curves(family) if able else None,
        over_number=over_number(family) if able else None,
    )


def monte_carlo_page(study: MonteCarlo) -> str:
    """The whole report on tolerances as HTML."""
    moving = monte_carlo_tables.moving(study)
    return render(
        "monte_carlo.html",
        many=study,
        engines={m.run.engine: m.run.version for m in study.judged.measurements},
        agreement=study.judged.agreement,
        tables=monte_carlo_tables,
        histograms=histograms(study) if moving else None,
        shares=variance_shares(study) if moving else None,
        drawing=_worst(study),
    )


def assemblies_page(scene: Scene, every: Assemblies) -> str:
    """The whole page on all assemblies as HTML; all pictures are at one scale."""
    alone = [Drawing(scene, assembly.motion) for assembly in every.found]
    pictures = [by_itself(Drawing(scene, drawing.motion, alone), 0) for drawing in alone]
    return render("assemblies.html", scene=scene, every=every, proof=proof, pictures=pictures)


def _shown(family: Family) -> Iterator[dict[str, Any]]:
    """Yield by name what the slider shows of the members that are drawn, all at one scale and with the same units."""
    chosen = [(member, member.judgement) for member, _ in drawn(family) if member.judgement is not None]
    named = family_tables.shown_units(family)
    alone = [Drawing(judged.scene, registry.motion(judged.scene, DRAWN), named=named) for _, judged in chosen]
    for (member, judged), drawing in zip(chosen, alone, strict=True):
        along = drawing.motion[axis(drawing.scene).channel]
        yield {
            "label": family_tables.label(family, member),
            "row": next(row for row, other in enumerate(family.members) if other is member),  # of the table
            "agreement": judged.agreement,
            "svg": by_itself(Drawing(drawing.scene, drawing.motion, alone, named), FRAMES),
            "ends": (float(along[0]), float(along[-1])),  # of the motion on the axis, SI
            "answers": answers(drawing.scene, judged.peaks, named),
        }


def _worst(study: MonteCarlo) -> str:
    """The worst machine moving; nothing where all are alike, or it locks where nobody looked before."""
    if study.worst is None:
        return ""
    scene = with_changes(study.scene, study.changes(study.worst[0]))
    try:
        return by_itself(Drawing(scene, registry.motion(scene, DRAWN), named=units(study.judged.reference)), FRAMES)
    except Failure:
        return ""
