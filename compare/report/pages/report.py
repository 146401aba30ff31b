"""The page on one scene: one self-contained HTML file, opened from disk with no network."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from scenes.scene import ConstantSpeed

from ...measure.speed.speed_table import SAMPLING
from ...measure.speed.work_precision import ALIKE, TIE
from ...mechanics.axis import axis, cycle_name, position_name
from ...study import Study
from ..extremes import affordable
from ..figures.curves import chosen, over_angle
from ..figures.description import described
from ..figures.figure import Figure
from ..figures.singular import assur_groups, over_distance
from ..figures.speed import work_precision
from ..linkage.moving import MovingPicture
from ..numbers import units
from ..tables import first_screen
from ..tables import speed as speed_tables
from ..tables import study as tables
from .html import render

if TYPE_CHECKING:
    from pandas import DataFrame

ONLY_ANALYTIC = (
    "A curve for each Assur group, named by its inner joint, from the reference, which alone knows such groups."
    " Distance: the least change of a length of the group, or of the offset of a guide, that makes the pose singular."
)
ROUND_OFF = (
    "Explained by round-off: errors that no calculation with 16 digits avoids, by the condition of the constraint"
    " Jacobian, or by how far the motion moves with the last digits of the scene's numbers. What is above is a fault."
)


def page(study: Study) -> str:
    """The whole report as HTML."""
    scene, (drawn, left_out) = study.scene, chosen(study)
    panels = [(panel.title, over_angle(study, panel), "") for panel in drawn]
    panels += _singular(study)
    most = affordable(figure.traces for _, figure, _ in panels)
    return render(
        "report.html",
        most=most,
        study=study,
        tables=tables,
        speed=speed_tables,
        answers=first_screen.answers(scene, study.peaks, units(study.reference)),
        engines=[*first_screen.engines(study)],
        moving=MovingPicture(study, drawn),
        axis=axis(scene),
        position=position_name(scene),
        cycle=cycle_name(scene),
        steady=isinstance(scene.drive, ConstantSpeed),
        panels=[(title, figure, described(title, figure), note) for title, figure, note in panels],
        left_out=[channel for panel in left_out for channel in panel.judged],
        picture=work_precision(study),
        speed_samples=SAMPLING.samples,
        near=f"{100 * ALIKE:.0f} %",
        tie=f"{100 * TIE:.0f} %",
        **in_full(study.hard, study.maps),
    )


def in_full(cases: "DataFrame | None", maps: "DataFrame | None") -> dict[str, Any]:
    """What the sections on hard cases and maps of stability use, by name; nothing where none was run."""
    if cases is None or maps is None:
        return {"cases": [], "maps": []}
    from ..figures.hard import over_condition, stability_maps  # late, as what few runs need
    from ..tables import hard

    return {"cases": cases, "maps": [*stability_maps(maps)], "hard": hard, "over_condition": over_condition}


def _singular(study: Study) -> Iterator[tuple[str, Figure, str]]:
    """Yield title, figure and a note of the figures of singular configurations."""
    if (groups := assur_groups(study)) is not None:
        title = "Assur groups: transmission angle, and distance to the singular configuration"
        yield title, groups, ONLY_ANALYTIC
    if (distance := over_distance(study)) is not None:
        yield "Errors against the distance to the singular configuration", distance, ROUND_OFF
