"""The page on a scene that cannot run: the line that says why, the pose where it stops, and how far it goes."""

from collections.abc import Sequence
from math import inf, tau

import numpy as np

from scenes import Scene
from scenes.model.enclosures import MotionRange

from ...judge.agreement import Agreement, Word
from ...judge.floor import UnsolvedError
from ..linkage.still import sketched, stopped
from .html import render


def unsolved_page(scene: Scene, unsolved: UnsolvedError, way: MotionRange | None, changed: Sequence[object]) -> str:
    """The whole page as HTML, by how far the linkage goes; `changed` is what did since an earlier run."""
    _, joint = (unsolved.failure and unsolved.failure.at) or (0.0, "")
    return render(
        "unsolved.html",
        scene=scene,
        unsolved=unsolved,
        agreement=Agreement(Word.not_solved, str(unsolved)),
        way=way,
        asked=[scene.position(end) for end in scene.drive.extent],
        goes=[tuple(scene.position(end) for end in ends) for ends in way.ways] if way else [],
        stripes=_stripes(scene, way) if way else [],
        picture=stopped(scene, way) if way else sketched(scene, joint),
        where=scene.where(float(way.motion[scene.drive_channel][0])) if way else "",
        changed=changed,
    )


def _stripes(scene: Scene, way: MotionRange) -> list[tuple[float, float]]:
    """Where the drive's range, from 0 to 100, has each part in which the linkage goes: its begin and its length."""
    (least, most), turn = scene.drive.extent, tau if scene.driven_slide is None else inf
    shifts = (0.0,) if turn == inf else (-turn, 0.0, turn)
    ends = [[np.clip(end + shift, least, most) for end in ends] for ends in way.ways for shift in shifts]
    return [(100 * (a - least) / (most - least), 100 * (b - a) / (most - least)) for a, b in ends if b > a]
