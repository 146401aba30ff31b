"""A linkage of dyads with some of them as one larger group, which the core solves by Newton's method."""

from dataclasses import replace

from analytic.core.decomposition import Linkage, _Placed, decompose, larger_group, members
from scenes import Scene


def as_one_group(scene: Scene, kept: int = 0) -> Linkage:
    """The decomposition with all dyads but the first ones as one group; -1 for the last dyad alone."""
    linkage = decompose(scene)
    dyads = linkage.groups[:kept]
    placed = _Placed(scene, linkage.bodies)
    for body in (scene.drive.body, *(body for dyad in dyads for body in members(dyad))):
        placed.add(body)
    group = larger_group(placed, tuple(body for body in linkage.carries if body not in placed.carries))
    return replace(linkage, groups=(*dyads, group))
