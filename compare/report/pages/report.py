"""The page on one scene, or on one that cannot run: a self-contained HTML file, opened from disk with no network."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from scenes import Motion, Scene
from scenes.model.enclosures import MotionRange

from ...judge.agreement import Agreement, Word
from ...judge.floor import UnsolvedError
from ...measure.speed.share import SAMPLING
from ...measure.speed.work_precision import CHOICE_TOL, TIE_TOL
from ...mechanics.axis import axis, cycle_name, position_name
from ...study import Study
from ..bench.bench import Bench
from ..figures.curves import assur_groups, chosen, friction, over_angle, over_distance
from ..figures.figure import Attributes, Figure, affordable
from ..figures.speed import work_precision
from ..figures.style import FLOOR, ROUND_OFF
from ..linkage.moving import MovingPicture
from ..linkage.still import sketched, stopped
from ..numbers import short, units
from ..output.earlier import Before, at_positions
from ..tables import first_screen
from ..tables import friction as friction_tables
from ..tables import proof as proof_tables
from ..tables import speed as speed_tables
from ..tables import study as tables
from .html import render


def page(study: Study, before: Before | None = None) -> str:
    """The whole report as HTML, beside an earlier run if there is one."""
    scene, (drawn, left_out), earlier = study.scene, chosen(study), before or Before((), {}, Motion({}))
    earlier = replace(earlier, motion=at_positions(scene, earlier.motion, study.motion))
    panels = {panel.title: over_angle(study, panel, earlier.motion) for panel in drawn}
    groups, distance = assur_groups(study), over_distance(study)
    most = affordable(figure.traces for figure in (*panels.values(), groups, distance) if figure is not None)
    moving = MovingPicture(study, drawn, earlier)
    return render(
        "report.html",
        most=most,
        study=study,
        tables=tables,
        speed=speed_tables,
        answers=first_screen.answers(scene, first_screen.of_ok(study), units(study.reference), earlier.peaks),
        engines=[*first_screen.engines(study)],
        moving=moving,
        bench=Bench(study, moving),
        axis=axis(scene),
        position=position_name(scene),
        cycle=cycle_name(scene),
        steady=scene.steady,
        panels=panels,
        groups=groups,
        distance=distance,
        friction=friction(study) if scene.friction else None,
        friction_tables=friction_tables,
        proof=proof_tables,
        described=described,
        left_out=[channel for panel in left_out for channel in panel.judged],
        picture=work_precision(study) if study.speed else None,
        speed_samples=SAMPLING.samples,
        near=f"{100 * CHOICE_TOL:.0f} %",
        tie=f"{100 * TIE_TOL:.0f} %",
        **in_full(study),
    )


def unsolved_page(scene: Scene, unsolved: UnsolvedError, way: MotionRange | None, changed: Sequence[object]) -> str:
    """The page on a scene that cannot run, by how far it goes; `changed` is what did since an earlier run."""
    _, joint = (unsolved.failure and unsolved.failure.at) or (0.0, "")
    return render(
        "unsolved.html",
        scene=scene,
        unsolved=unsolved,
        agreement=Agreement(Word.not_solved, unsolved.sentence),
        way=way,
        joint=joint,
        whole=", ".join(scene.between(drive.law.extent) for drive in scene.drives),
        goes=[scene.between(ends) for ends in way.ways] if way else [],
        picture=stopped(scene, way) if way else sketched(scene, joint),
        where=scene.where(float(way.motion[scene.channels.drive.position][0])) if way else "",
        changed=changed,
    )


def in_full(study: Study) -> dict[str, Any]:
    """What the sections on hard cases and maps of stability use, by name; nothing where none was run."""
    if study.hard is None or study.maps is None:
        return {"cases": [], "maps": []}
    from ..figures.hard import over_condition, stability_maps  # late, as what few runs need
    from ..tables import hard

    maps = [*stability_maps(study.maps)]
    return {"cases": study.hard, "maps": maps, "hard": hard, "over_condition": over_condition}


def described(title: str, figure: Figure) -> str:
    """A figure in words, for those who do not see it: the least and the largest value by panel, and where they are."""
    panels: dict[str, list[Attributes]] = {}
    for trace in figure.traces:
        if trace["name"] and trace["name"] not in (FLOOR, ROUND_OFF) and len(trace["x"]):
            panels.setdefault(trace["yaxis"], []).append(trace)
    axes = {name: part["title"]["text"] for name, part in figure.layout.items() if "axis" in name and "title" in part}
    along = [title for name, title in axes.items() if name.startswith("x")]
    notes = [note["text"] for note in figure.layout.get("annotations", ())]
    names = notes or [axes[f"yaxis{panel.removeprefix('y')}"] for panel in panels]
    sentences = [f"{title}, over {along[-1]}"] if along else [title]
    for name, traces in zip(names, panels.values(), strict=False):
        lines = [trace for trace in traces if trace["mode"] == "lines"]  # markers lie on them
        sentences.append(f"{name}: {_extremes(lines or traces)}")
    return ". ".join(sentences) + "."


def _extremes(traces: Sequence[Attributes]) -> str:
    """The least and the largest value of some curves, each with its place and the name of its curve."""
    y, x = (np.concatenate([np.asarray(trace[axis], float) for trace in traces]) for axis in "yx")
    if not np.isfinite(y).any():
        return "no values"
    names = [trace["name"] for trace in traces for _ in trace["y"]]
    ends = (f"{short(float(y[n]))} ({names[n]}) at {short(float(x[n]))}" for n in (np.nanargmin(y), np.nanargmax(y)))
    return f"from {' to '.join(ends)}"
