"""What errors are divided by, and errors so divided: points by how far they travel, forces by their peaks."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from scenes import Motion, Scene
from scenes.channels import TIME, Channel, Channels, Role
from scenes.model.motion import Samples

from .contacts import CONTACTS
from .mechanics import Mechanics
from .motion_vectors import MotionVectors, Vectors

MAX_OFF_ORIGIN = 10.0  # sizes of a linkage, within which its places are rounded by little more than its lengths
MIN_TRAVEL = 1e-2  # of the largest travel: what a point's own is taken for at least
NOTHING = 1e-12  # of the largest force: what a joint carries that carries but round-off
RESTING_TOL = 1e-6  # of the largest rate: where a joint turns round, within what engines find of its rate
STEADY_TOL = 1e-6  # of T w^2, and of what it takes for the heaviest body: what engines find where nothing accelerates


def scales(
    mechanics: Mechanics, motion: Motion, travel: Mapping[str, float], acting: Mapping[str, Samples]
) -> dict[str, float]:
    """What errors are divided by, channel by channel.

    `travel` is that of each moving point, m, see `travels`; `acting` has the `magnitudes` of all that acts, N.

    Points are scaled by their own travel T, T w and T w^2; turning by 1 rad, w and w^2; forces by the peak magnitude of
    their pin, guide or drive. w is the crank's peak rate, or that of a driven slider over its travel.
    """
    channels = mechanics.scene.channels
    peaks = {name: float(magnitude(motion, channels[name]).max()) for name in (*mechanics.forces, *mechanics.friction)}
    for slider, (force, moment) in channels.guides.items():
        natural = max(travel[point] for point in mechanics.along_guides[slider]) * peaks[force]
        peaks[moment] = max(peaks[moment], natural)  # often zero by symmetry
    for friction in mechanics.scene.friction:
        contact = CONTACTS[type(friction)]
        arm = 1.0 if contact.turns else max(travel.values())
        rate = contact.rate(friction, MotionVectors(mechanics.scene, motion))
        if np.abs(rate).max() <= STEADY_TOL * arm * mechanics.scene.pace:
            peaks[friction.channel(mechanics.scene)] = 0.0  # noise, of a joint that never moves
    strongest = max((float(term.max()) for term in acting.values()), default=0.0)
    return _kinematic(mechanics, travel) | force_scales(mechanics, motion, travel, peaks, strongest)


def _kinematic(mechanics: Mechanics, travel: Mapping[str, float]) -> dict[str, float]:
    """What errors of all channels but forces are divided by."""
    scene, w = mechanics.scene, mechanics.scene.pace
    scale = {TIME: scene.cycle, scene.channels.drive.position: mechanics.way}
    for point, T in travel.items():
        scale |= {name: T * w**order for order, both in enumerate(scene.channels.points[point]) for name in both}
    for rates in scene.channels.bodies.values():
        scale |= {name: w**order for order, name in enumerate(rates)}
    return scale


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
    known, channels = _kinematic(mechanics, travel), mechanics.scene.channels
    second = [name for name in motion.samples if name in known and channels[name].order == 2]
    # Nothing accelerates and no force is above round-off: a scale of its peak would make noise of it an error of order
    # one.
    still = (np.abs(motion[name]).max() <= STEADY_TOL * known[name] for name in second)
    if largest <= STEADY_TOL * natural and all(still):
        return dict.fromkeys(peaks, min(natural, 1.0) or 1.0)
    largest = largest or 1.0
    return {name: peak if peak > NOTHING * largest else largest for name, peak in peaks.items()}


def magnitude(motion: Motion, channel: Channel) -> Samples:
    """The magnitude of the vector of a component, of the channel itself otherwise, shape (n,)."""
    if not channel.axis:
        return np.abs(motion[channel.name])
    x, y = channel.components
    return np.hypot(motion[x], motion[y])


def sizes(true: Motion, channel: Channel, scale: float) -> Samples:
    """What errors of a channel are divided by, shape (n,): the larger of its scale and of its magnitude there.

    Places and angles have no magnitude, which would depend on where one counts from. The drive's is how far it came.
    """
    if channel.role is Role.input:
        return np.maximum(scale, np.abs(true[channel.name] - true[channel.name][:1]))
    if channel.order == 0:
        return np.full(true["time"].shape, scale)
    return np.maximum(scale, magnitude(true, channel))


def relative_errors(channels: Channels, motion: Motion, true: Motion, scale: Mapping[str, float]) -> dict[str, Samples]:
    """The error of each channel over its size, each of shape (n,); that of a component is its vector's.

    Angles are compared modulo one turn. The time is an input, and what only one model returns has no scale: neither is
    compared.
    """
    judged = [name for name in motion.samples if name != TIME and name in scale and name in true]
    errors: dict[str, Samples] = {}
    for name in judged:
        channel = channels[name]
        other = next((each for each in channel.components if each != name), "") if channel.axis else ""
        if other in errors and scale[other] == scale[name]:
            errors[name] = errors[other]  # the same array: errors are half of what a long run keeps in memory
            continue
        pair = motion[name], true[name]
        distance = np.abs(apart(channel, *pair) if channel.modulo_turn else pair[0] - pair[1])  # a drive counts turns
        if other in judged:
            distance = np.hypot(distance, motion[other] - true[other])
        errors[name] = distance / sizes(true, channel, scale[name])
    return errors


def judged_errors(mechanics: Mechanics, motion: Motion, true: Motion, scale: Mapping[str, float]) -> dict[str, Samples]:
    """Relative errors as they count: zero of forces where a joint with friction is at rest in the true motion."""
    errors = relative_errors(mechanics.scene.channels, motion, true, scale)
    if mechanics.friction:
        at_rest = resting(MotionVectors(mechanics.scene, true))
        for channel in {*mechanics.forces, *mechanics.friction} & errors.keys():
            errors[channel] = np.where(at_rest, 0.0, errors[channel])
    return errors


def resting(state: MotionVectors) -> NDArray[np.bool_]:
    """Where the sense of a joint's motion is not known, so that nothing is judged by the forces; shape (n,)."""
    scene = state.scene
    turning = np.max([np.abs(state.turning(body)[1]) for body in scene.bodies], axis=0)
    moving = np.max([np.abs(state.place(point, 1)) for point in scene.moving_points], axis=0)
    inputs = state.motion.inputs(scene)
    rates = [inputs.driven(number).rate / drive.law.peak_rate for number, drive in enumerate(scene.drives)]
    slow: NDArray[np.bool_] = np.abs(rates).max(axis=0) <= RESTING_TOL
    for friction in scene.friction:
        contact = CONTACTS[type(friction)]
        if friction.smooth is None:
            slow |= np.abs(contact.rate(friction, state)) <= RESTING_TOL * (turning if contact.turns else moving)
    return slow


def apart(channel: Channel, values: Samples, others: Samples) -> Samples:
    """By how much samples of a channel are more than others, directions modulo one turn."""
    difference = values - others
    return np.remainder(difference + np.pi, 2 * np.pi) - np.pi if channel.is_angle else difference


def off_origin(mechanics: Mechanics, motion: Motion) -> Samples:
    """How far off the origin places are, in sizes of the linkage, one at least: they are rounded by as much."""
    points = mechanics.scene.channels.points.values()
    places = [np.hypot(*(motion[name] for name in names.place)) for names in points]
    off: Samples = np.max(places, axis=0) / mechanics.size
    return np.where(off > MAX_OFF_ORIGIN, off, 1.0)


def travels(scene: Scene, motion: Motion) -> dict[str, float]:
    """The largest distance between two positions of each point of a motion, m; at least `MIN_TRAVEL` of the largest."""
    places = {point: names.place for point, names in scene.channels.points.items()}
    known = {point: both for point, both in places.items() if {*both} <= motion.samples.keys()}
    chords = {point: abs(chord(motion[x] + 1j * motion[y])) for point, (x, y) in known.items()}
    least = MIN_TRAVEL * max(chords.values(), default=0.0)
    return {point: max(travel, least) for point, travel in chords.items()}


def chord(places: Vectors) -> complex:
    """The longest vector from one to another of some positions, x + iy, shape (n,); exact, by n log n.

    It is one between corners of their convex hull that two parallel lines touch (rotating calipers, Shamos 1978): the
    corner opposite to an edge has that edge's direction, turned by half a turn, between those of its own two edges.
    """
    # Andrew's monotone chain from left to right and back gives the hull counter-clockwise. Edge directions rise once
    # round, so that the corner opposite to an edge is found by bisection for the direction turned by pi.
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
