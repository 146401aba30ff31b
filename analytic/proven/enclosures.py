"""What is proven of a scene over its whole range: that it assembles, and bounds of every channel's extremes."""

from collections.abc import Mapping
from collections.abc import Set as AbstractSet
from itertools import product

import numpy as np

from scenes import Scene
from scenes.arguments import finite_numbers, known_names, refuse, scene_of
from scenes.model.enclosures import Enclosure, Enclosures
from scenes.model.motion import Samples

from .boxes import Boxes
from .extremes import extremes


def enclose(
    scene: Scene,
    names: AbstractSet[str] | None = None,
    accuracy: float = 1e-6,
    off: Mapping[str, float] | None = None,
) -> Enclosures:
    """Prove what the extremes of channels and magnitudes are over all positions of a cycle, between samples too.

    Args:
        scene: the mechanism.
        names: channels, and the magnitudes `P.force`, `P.speed`, `P.acceleration` and `transmission`; None for all.
        accuracy: how far the bounds may be apart, of what the channel changes by; as far as doubles can decide.
        off: by how much numbers of the scene may be off either way, SI, by path in the file: the extremes are then
            those of all machines within that, and the bounds are apart by what a linear model of the numbers leaves.

    Raises:
        Failure: as of `solver`.
        InputError: no scene, no such name, or an accuracy that is no number above zero.
    """
    numbers = scene_of(scene).numbers
    known_names("off", off or {}, numbers)
    finite_numbers("off", [*(off or {}).values()])
    if not finite_numbers("accuracy", accuracy) > 0:
        refuse("accuracy", "a number above zero", accuracy)
    boxes = Boxes(scene, names, off or {})
    bounds, open_at = extremes(boxes, accuracy)
    extreme = product(boxes.names, ("least", "most"))
    rows = [Enclosure(*names, *of) for names, of in zip(extreme, bounds.T.reshape(-1, 4).tolist(), strict=True)]
    return Enclosures(rows if open_at is None else (), open_at)


def departures(scene: Scene, edges: Samples, names: AbstractSet[str] | None = None) -> Mapping[str, Samples]:
    """How far channels and magnitudes may leave the straight line between neighbouring places, SI.

    Args:
        scene: the mechanism.
        edges: positions of the drive, rad or m, or instants, s, under a motion law; shape (n + 1,), increasing.
        names: as of `enclose`.

    Returns:
        By name, shape (n,); NaN where nothing is known.

    Raises:
        Failure: as of `solver`.
        InputError: no scene, no such name, or places that are none, or do not increase.
    """
    edges = finite_numbers("edges", edges)
    if edges.ndim != 1 or not (np.diff(edges) > 0).all() or not edges[1:].size:
        refuse("edges", "two places or more, increasing", edges)
    boxes = Boxes(scene_of(scene), names, {})
    ends = np.union1d(edges, boxes.edges[(boxes.edges > edges[0]) & (boxes.edges < edges[-1])])
    models, own = boxes(ends[:-1], ends[1:])
    low, high = models.range
    first = np.searchsorted(ends[own], edges[:-1])  # of the models between two places
    apart = np.maximum.reduceat(high, first, axis=1) - np.minimum.reduceat(low, first, axis=1)
    single = np.diff(np.append(first, len(own))) == 1  # without a jump between them, and within one piece of a law
    off = np.where(single, (np.abs(models.c[2]) + 2 * models.rest)[:, first], apart)
    return dict(zip(boxes.names, off, strict=False))  # the conditions come last
