"""What errors are divided by, and errors so divided: points by how far they travel, forces by their peaks."""

from collections.abc import Mapping, Sequence

import numpy as np

from scenes import Motion, Scene
from scenes.model.motion import Samples, quantity

from .contacts import CONTACTS
from .elements import magnitudes
from .friction import rate
from .mechanics import Mechanics
from .motion_vectors import MotionVectors, Vectors

FAR = 10.0  # sizes of a linkage off the origin, within which its places are rounded by little more than its lengths
LEAST = 1e-2  # of the largest travel: what a point's own is taken for at least
NOTHING = 1e-12  # of the largest force: what a joint carries that carries but round-off
REST = 1e-6  # of T w^2, and of what it takes for the heaviest body: what engines find where nothing accelerates
POWERS = {"x": 0, "y": 0, "vx": 1, "vy": 1, "ax": 2, "ay": 2}  # of w, in what points are scaled by
TURNING = ("angle", "omega", "alpha")  # by power of w
SECOND = (".ax", ".ay", ".alpha")  # channels of accelerations
PLACES = (".x", ".y", ".angle")  # channels whose magnitude depends on where one counts from
DRIVEN = ("crank_angle", "drive.displacement")


def scales(mechanics: Mechanics, motion: Motion, travel: Mapping[str, float]) -> dict[str, float]:
    """What errors are divided by, channel by channel; `travel` is that of each moving point, m, see `travels`.

    Points are scaled by their own travel T, T w and T w^2; turning by 1 rad, w and w^2; forces by the peak magnitude of
    their pin, guide or drive. w is the crank's peak rate, or that of a driven slider over its travel.
    """
    forces = (*mechanics.forces, *mechanics.friction)
    peaks = {channel: float(magnitude(motion, channel).max()) for channel in forces}
    for slider, points in mechanics.along_guides.items() if peaks else ():
        natural = max(travel[point] for point in points) * peaks[f"{slider}.guide_force"]
        peaks[f"{slider}.guide_moment"] = max(peaks[f"{slider}.guide_moment"], natural)  # often zero by symmetry
    for one in mechanics.scene.friction:
        arm = 1.0 if CONTACTS[type(one)].turns else max(travel.values())
        if np.abs(rate(MotionVectors(mechanics.scene, motion), one)).max() <= REST * arm * mechanics.scene.pace:
            peaks[one.channel(mechanics.scene)] = 0.0  # noise, of a joint that never moves
    terms = magnitudes(MotionVectors(mechanics.scene, motion), mechanics.size) if peaks else {}
    strongest = max((float(term.max()) for term in terms.values()), default=0.0)
    return _kinematic(mechanics, travel) | force_scales(mechanics, motion, travel, peaks, strongest)


def _kinematic(mechanics: Mechanics, travel: Mapping[str, float]) -> dict[str, float]:
    """What errors of all channels but forces are divided by."""
    scene, w = mechanics.scene, mechanics.scene.pace
    scale = {"time": scene.cycle, scene.drive_channel: mechanics.way}
    scale |= {f"{point}.{of}": T * w**power for point, T in travel.items() for of, power in POWERS.items()}
    return scale | {f"{body}.{of}": w**power for body in scene.turning for power, of in enumerate(TURNING)}


def force_scales(
    mechanics: Mechanics,
    motion: Motion,
    travel: Mapping[str, float],
    peaks: Mapping[str, float],
    strongest: float = 0.0,
) -> dict[str, float]:
    """What errors of forces are divided by: their peak, or the largest of all where it is rounding.

    The `strongest` load, spring, weight or inertia, N, counts among these: loads may balance each other, and a drive
    that moves a mass as its spring would has nothing to do. Where nothing accelerates and nothing pushes, all are
    rounding: then 1 N, or what T w^2 of the largest travel takes for the heaviest body if that is less.
    """
    largest = max(strongest, *peaks.values()) if peaks else 0.0
    heaviest = max(body.mass or 0.0 for body in mechanics.scene.bodies.values())
    natural = heaviest * max(travel.values()) * mechanics.scene.pace**2
    known = _kinematic(mechanics, travel)
    still = (np.abs(motion[c]).max() <= REST * known[c] for c in motion.samples if c in known and c.endswith(SECOND))
    if largest <= REST * natural and all(still):
        return dict.fromkeys(peaks, min(natural, 1.0) or 1.0)
    largest = largest or 1.0
    return {name: peak if peak > NOTHING * largest else largest for name, peak in peaks.items()}


def magnitude(motion: Motion, channel: str) -> Samples:
    """The magnitude of the vector of a component, of the channel itself otherwise, shape (n,)."""
    stem, axis = channel[:-1], channel[-1]
    return np.hypot(motion[stem + "x"], motion[stem + "y"]) if axis in "xy" else np.abs(motion[channel])


def sizes(true: Motion, channel: str, scale: float) -> Samples:
    """What errors of a channel are divided by, shape (n,): the larger of its scale and of its magnitude there."""
    if channel.endswith(PLACES):  # which have no magnitude; that of the drive is how far it has come
        return np.full(true["time"].shape, scale)
    if channel in DRIVEN:
        return np.maximum(scale, np.abs(true[channel] - true[channel][:1]))
    return np.maximum(scale, magnitude(true, channel))


def relative_errors(motion: Motion, true: Motion, scale: Mapping[str, float]) -> dict[str, Samples]:
    """The error of each channel over its size, each of shape (n,); that of a component is its vector's.

    Angles are compared modulo one turn. The time is an input, and what only one model returns has no scale: neither is
    compared.
    """
    judged = [channel for channel in motion.samples if channel != "time" and channel in scale and channel in true]
    errors: dict[str, Samples] = {}
    for channel in judged:
        stem, axis = channel[:-1], channel[-1]
        other = stem + {"x": "y", "y": "x"}[axis] if axis in "xy" else ""
        if other in errors and scale[other] == scale[channel]:
            errors[channel] = errors[other]  # the same array: errors are half of what a long run keeps in memory
            continue
        pair = motion[channel], true[channel]
        distance = np.abs(pair[0] - pair[1] if channel in DRIVEN else apart(channel, *pair))  # a drive counts its turns
        if other in judged:
            distance = np.hypot(distance, motion[other] - true[other])
        errors[channel] = distance / sizes(true, channel, scale[channel])
    return errors


def apart(channel: str, one: Samples, other: Samples) -> Samples:
    """By how much samples of a channel are more than others, angles modulo one turn."""
    difference = one - other
    of_angle = quantity(channel) in ("angle", "crank_angle")
    return np.remainder(difference + np.pi, 2 * np.pi) - np.pi if of_angle else difference


def off_origin(mechanics: Mechanics, motion: Motion) -> Samples:
    """How far off the origin places are, in sizes of the linkage, one at least: they are rounded by as much."""
    places = [np.hypot(motion[f"{p}.x"], motion[f"{p}.y"]) for p in mechanics.scene.moving_points]
    off: Samples = np.max(places, axis=0) / mechanics.size
    return np.where(off > FAR, off, 1.0)


def travels(scene: Scene, motion: Motion) -> dict[str, float]:
    """The largest distance between two positions of each point of a motion, m, no less than `LEAST` of the largest."""
    known = [point for point in scene.moving_points if {f"{point}.x", f"{point}.y"} <= motion.samples.keys()]
    own = {point: abs(chord(motion[f"{point}.x"] + 1j * motion[f"{point}.y"])) for point in known}
    least = LEAST * max(own.values(), default=0.0)
    return {point: max(travel, least) for point, travel in own.items()}


def chord(places: Vectors) -> complex:
    """The longest vector from one to another of some positions, x + iy, shape (n,); exact, by n log n.

    It is one between corners of their convex hull that two parallel lines touch (rotating calipers, Shamos 1978): the
    corner opposite to an edge has that edge's direction, turned by half a turn, between those of its own two edges.
    """
    ordered = np.sort(places)  # by x, then by y
    hull = np.array(_below(ordered.tolist())[:-1] + _below(ordered[::-1].tolist())[:-1])
    if len(hull) < 3:
        return complex(ordered[-1] - ordered[0])
    ends = np.roll(hull, -1)
    edges = np.unwrap(np.angle(ends - hull))  # rising, round once
    opposite = hull[np.searchsorted([*edges, *(edges + 2 * np.pi)], edges + np.pi) % len(hull)]
    pairs = np.concatenate([hull - opposite, ends - opposite, ordered[-1:] - ordered[:1]])  # these if but for round-off
    return complex(pairs[np.abs(pairs).argmax()])


def _below(places: Sequence[complex]) -> list[complex]:
    """The hull's corners from the first to the last of sorted positions, to the right of that way (Andrew 1979)."""
    corners: list[complex] = []
    for place in places:
        while len(corners) > 1 and ((corners[-1] - corners[-2]).conjugate() * (place - corners[-1])).imag <= 0:
            corners.pop()
        corners.append(place)
    return corners
