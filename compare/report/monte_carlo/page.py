"""The page of tolerances: what the workshop does to the designer's numbers, in tables and pictures."""

from scenes import Failure, Sampling, load

from ...engines import registry
from ...monte_carlo.study import MonteCarlo
from .. import first_screen
from ..html import render
from ..linkage.drawing import Drawing
from ..linkage.svg import by_itself
from . import tables
from .figure import histograms, variance_shares

DRAWN, FRAMES = Sampling(144), 36  # samples and poses of the drawing


def page(study: MonteCarlo) -> str:
    """Return the whole report as HTML."""
    agreement, shown = study.judged.agreement, tables.moving(study)
    return render(
        "monte_carlo/monte_carlo.html",
        study=study,
        tables=tables,
        agreement=agreement,
        mark=first_screen.MARKS[agreement.word],
        histograms=histograms(study) if shown else None,
        shares=variance_shares(study) if shown else None,
        drawing=_drawing(study),
        engines={m.run.engine: m.run.version for m in study.judged.measurements},
    )


def _drawing(study: MonteCarlo) -> str:
    """Return the worst machine moving; nothing where all are alike, or it locks where nobody looked before."""
    if study.worst is None:
        return ""
    scene = load(study.scene.file, study.changes(study.worst[0]))
    try:
        motion = registry.reference(scene)(DRAWN.commanded(scene), DRAWN.times(scene))
    except Failure:
        return ""
    return by_itself(Drawing(scene, motion), FRAMES)
