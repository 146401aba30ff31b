"""The page: one self-contained HTML file, opened from disk with no network."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from scenes.scene import ConstantSpeed

from ..engines.axis import axis, cycle_name, position_name
from ..speed.speed_table import SAMPLING
from ..speed.work_precision import NEAR, TIE
from ..study import Study
from . import first_screen, tables
from .curves import Panel, chosen, over_angle
from .description import described
from .extremes import affordable
from .figure import Figure
from .html import render
from .linkage.moving import Moving
from .singular import assur_groups, over_distance
from .speed import tables as speed_tables
from .speed.figure import work_precision
from .units import units

ONLY_ANALYTIC = (
    "A curve for each Assur group, named by its inner joint, from the reference, which alone knows such groups."
    " Distance: the least change of a length of the group, or of the offset of a guide, that makes the pose singular."
)

ROUND_OFF = (
    "Explained by round-off: errors that no calculation with 16 digits avoids, by the condition of the constraint"
    " Jacobian, or by how far the motion moves with the last digits of the scene's numbers. What is above is a fault."
)


def page(study: Study) -> str:
    """Return the whole report as HTML."""
    scene, (drawn, left_out) = study.scene, chosen(study)
    sections = list(_sections(study, drawn))
    numbers = scene, study.peaks, units(study.reference)
    most = affordable(figure.traces for _, figure, _, _ in sections)
    return render(
        "report.html",
        most=most,
        study=study,
        tables=tables,
        speed=speed_tables,
        mark=first_screen.MARKS[study.agreement.word],
        peaks=first_screen.peaks(*numbers),
        joints=first_screen.joints(*numbers),
        engines=[*first_screen.engines(study)],
        moving=Moving(study, drawn),
        axis=axis(scene),
        position=position_name(scene),
        cycle=cycle_name(scene),
        steady=isinstance(scene.drive, ConstantSpeed),
        sections=sections,
        not_drawn=_not_drawn(study, most, left_out),
        picture=work_precision(study),
        speed_samples=SAMPLING.samples,
        near=f"{100 * NEAR:.0f} %",
        tie=f"{100 * TIE:.0f} %",
        **_in_full(study),
    )


def _in_full(study: Study) -> dict[str, Any]:
    """Return what the section about hard cases and maps of stability uses, by name."""
    if study.maps is None or study.hard is None:
        return {"maps": [], "hard": {}}
    from .hard.section import hard_cases  # late, as what few runs need
    from .hard.stability import stability_maps

    return {"maps": [*stability_maps(study.maps)], "hard": hard_cases(study.hard)}


def _sections(study: Study, drawn: Iterable[Panel]) -> Iterator[tuple[str, Figure, str, str]]:
    """Yield title, figure, its text and a note of the panels, and of the figures of singular configurations."""
    for panel in drawn:
        figure = over_angle(study, panel)
        yield panel.title, figure, described(panel.title, figure), ""
    groups, distance = assur_groups(study), over_distance(study)
    if groups is not None:
        title = "Assur groups: transmission angle, and distance to the singular configuration"
        yield title, groups, described(title, groups), ONLY_ANALYTIC
    if distance is not None:
        title = "Errors against the distance to the singular configuration"
        yield title, distance, described(title, distance), ROUND_OFF


def _not_drawn(study: Study, most: int, left_out: Sequence[Panel]) -> str:
    """Return what of the motion is not drawn, in a sentence or two."""
    sentences, count = [], study.sampling.count
    if count > most:
        sentences.append(
            f"Drawn: at most {most:,} of {count:,} samples a curve, with the first, last, least and largest of every"
            " stretch. All tables are of all samples."
        )
    if left_out:
        names = ", ".join(channel for panel in left_out for channel in panel.judged)
        sentences.append(f"Not drawn, since their errors are smaller than those of the joints here: {names}.")
    return " ".join([*sentences, "Every sample is in motion.*.csv."]) if sentences else ""
