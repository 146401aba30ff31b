"""The page on a scene that cannot run: the line that says why, the pose where it stops, and how far it goes."""

from collections.abc import Sequence

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
        goes=[scene.between(ends) for ends in way.ways] if way else [],
        picture=stopped(scene, way) if way else sketched(scene, joint),
        where=scene.where(float(way.motion[scene.drive_channel][0])) if way else "",
        changed=changed,
    )
