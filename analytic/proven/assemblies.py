"""All assemblies of a linkage at a position of its drive, and which of them are on one circuit.

A dyad is assembled in two ways, and in one where two guides cross. From one to the other without taking it apart a
linkage gets where the dyad is in a singular configuration, at an end of an interval of the drive's range in which it
assembles; not where guides become parallel, as they cross infinitely far away.

Of a larger group none is missed, and each is known to be one. The joints are linear in where the bodies' first points
are. These go by the null space of the joints' incidence matrix, which leaves the closed loops, of attitudes u_c =
exp(i phi_c) and displacements s_k along guides; phi_0 = 0 is what stays where it is, so that its column has all that is
constant:

    F = sum_c (W_c + sum_k s_k V_kc) u_c = 0.                                                                   (1)

Boxes of (phi, s) are divided until F is zero nowhere in them, or one zero is alone around them (Krawczyk's operator, as
in Moore, Kearfott, Cloud, Introduction to Interval Analysis, 2009, chapter 8).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from math import inf, remainder, sqrt
from typing import Any

import numpy as np
from numpy.typing import NDArray

from scenes import Scene
from scenes.arguments import finite_numbers, refuse, scene_of
from scenes.channels import Role
from scenes.model.enclosures import Assemblies, Assembly
from scenes.model.motion import Samples

from ..core.decomposition import Dyad, Linkage, decompose, guides_cross
from ..core.groups.continuation import Track
from ..core.groups.group_equations import Complex, FramePoses, Group, GroupEquations, coordinates, equations_of
from ..core.groups.newton_group import own_jacobian
from ..core.kinematics import followed, placed
from ..recorded.arithmetics.systems import inverses
from ..solve import prepared
from ..way.motion_range import End, motion_at, motion_range
from ..way.singular import change_points

SAME_TOL = 1e-6  # of the longest arm, or of a range: two poses, ends of intervals, or boxes with one zero
MAX_BRANCHES = 64  # of dyads of which circuits are looked for, each by its whole range
PARTS = 4  # of the range of each unknown of a larger group, to begin with
MIN_BOX = 2.0**-24  # of that range: where two poses meet no box decides
MAX_BOXES = 50_000  # of a level: groups of four angles take up to a thousand
ROUND_OFF_TOL = 1e-11  # of the loops' terms: roundings
NEWTON_STEPS = 5  # from the middle of a box


def assemblies(scene: Scene, position: float | None = None, *, circuits: bool = True) -> Assemblies:
    """Find all ways to put the bodies together while the drive stays where it is.

    Args:
        scene: the mechanism.
        position: of the drive, rad or m; where the sketch shows it if None.
        circuits: whether to look for which are on one circuit, over the whole range of each.

    Raises:
        Failure: the linkage does not decompose, or a larger group does not close near the sketch.
    """
    place = finite_numbers("position", scene_of(scene).sketch.drive if position is None else position)
    if place.size != 1:
        refuse("position", "a number", position)
    place = place.reshape(1)
    whole, complete = decompose(scene), True
    drawn, ways = followed(scene, whole), [replace(whole, groups=())]
    for group in whole.groups:
        found = [_assembled(scene, way, group, place) for way in ways]
        ways, complete = [way for some, _ in found for way in some], complete and all(known for _, known in found)
    if not ways and not complete:  # of a group that is too large for it
        ways = [drawn]
    several = len(_branches(whole)) == len(whole.groups) and 2 ** len(whole.groups) <= MAX_BRANCHES
    known = _circuits(scene, whole, float(place[0])) if circuits and several else {}
    as_drawn, channels = motion_at(scene, drawn, place).z, frozenset(scene.channels.names(Role.kinematic))
    made = list[Assembly]()
    for way in ways:
        z = motion_at(scene, way, place).z
        if not all(np.isfinite(z[point]).all() for point in scene.moving_points):
            complete = False  # a group that can turn by itself there: two of its points are in one place
            continue
        distances = [np.ravel(z[point])[0] - complex(*xy) for point, xy in scene.sketch.points.items()]
        meant = all(np.all(np.abs(z[point] - as_drawn[point]) <= SAME_TOL * way.arm) for point in scene.moving_points)
        motion = replace(prepared(scene, way, channels), as_sketched=False)(place, np.zeros(1))
        away = float(np.linalg.norm(distances)) / sqrt(len(distances) or 1)
        made.append(Assembly(motion, meant, away, *known.get(_branches(way), (None, ()))))
    made.sort(key=lambda assembly: assembly.off_sketch)
    numbers = [*dict.fromkeys(assembly.circuit for assembly in made)]
    named = (
        assembly if assembly.circuit is None else replace(assembly, circuit=numbers.index(assembly.circuit))
        for assembly in made
    )
    return Assemblies(float(place[0]), [*named], complete)


def _branches(way: Linkage) -> tuple[Any, ...]:
    """The branches of the dyads, in the order of the groups."""
    return tuple(group.branch for group in way.groups if not isinstance(group, Group))


def _assembled(scene: Scene, before: Linkage, group: Dyad | Group, position: Samples) -> tuple[list[Linkage], bool]:
    """A linkage with a group in each of the ways in which it closes, and whether none is missed."""
    if not isinstance(group, Group):
        both = (replace(before, groups=(*before.groups, replace(group, branch=b))) for b in (1, -1))
        return [
            way for way in both if not np.any(motion_at(scene, way, position).reach.get(group.P, np.zeros(1)) < 0)
        ], True
    equations, frames = equations_of(scene, before.bodies, group), placed(scene, before, group, position).pose
    q, complete = poses(equations, FramePoses(frames.z[0], frames.angle[0]), float(position[0]))
    ways = []
    for pose in q[:, np.newaxis]:
        branch = float(np.linalg.slogdet(own_jacobian(equations, equations.pose(pose, frames)))[0][0])
        track = Track(equations, np.inf, np.inf, position, pose, 0 * pose, 0 * pose, branch)
        ways.append(replace(before, groups=(*before.groups, group), tracks={**before.tracks, group: track}))
    return ways, complete


def _known(place: End, others: Sequence[End], turn: float) -> bool:
    """Whether a place of the drive is among others, but for whole turns."""
    return any(joint == place[1] and abs(remainder(where - place[0], turn)) <= SAME_TOL for where, joint in others)


# Two assemblies are on one circuit if a motion leads from one to the other. Vertices are the intervals of the drive's
# way in which one choice of branches assembles; two are joined where they share an end (or a change point between), at
# which exactly the dyad that is singular has another branch. Circuits are the connected components. A gap or an
# interval between two samples of the way is not seen.
def _circuits(scene: Scene, whole: Linkage, position: float) -> Mapping[tuple[Any, ...], tuple[int, Sequence[End]]]:
    """By branches of dyads, the number of the circuit that a position is on, and where it meets others."""
    turn, parts = whole.drive.turn, list[tuple[tuple[Any, ...], tuple[End, ...]]]()
    for branches in product((1, -1), repeat=len(whole.groups)):
        groups: Any = (replace(group, branch=b) for group, b in zip(whole.groups, branches, strict=True))  # type: ignore[arg-type]
        way = replace(whole, groups=tuple(groups))
        met = change_points(scene, way)
        touched = [place for n, place in enumerate(met) if not _known(place, met[:n], turn)]
        for first, last in motion_range(scene, way) or [((-inf, ""), (inf, ""))]:
            whole_way = first[0] == -inf
            inner = [p for p in touched if whole_way or (p[0] - first[0]) % turn <= last[0] - first[0]]
            parts.append((branches, (first, *inner, last)))

    apart = {group.P for group in whole.groups if guides_cross(group)}

    def meet(i: int, j: int) -> bool:
        (a, first), (b, second) = parts[i], parts[j]
        flipped = [group.P for group, p, q in zip(whole.groups, a, b, strict=True) if p != q]
        pairs = product(first, second) if apart.isdisjoint(flipped) else ()
        # The same position of the drive, the same singular joint, and no dyad but that one flipped.
        return any([p] == flipped and p == q and abs(remainder(x - y, turn)) <= SAME_TOL for (x, p), (y, q) in pairs)

    count, here = range(len(parts)), dict[tuple[Any, ...], tuple[int, Sequence[End]]]()
    circuit = together(np.array([[i == j or meet(i, j) for j in count] for i in count]))
    for number, (branches, ends) in enumerate(parts):  # none in a gap that is too narrow to be seen
        (start, _), *_, (end, _) = ends
        if not (position - start + SAME_TOL) % turn > end - start + 2 * SAME_TOL:
            met = [end for end in ends if end[1] and end[1] not in apart]
            here.setdefault(branches, (int(circuit[number]), met))
    return here


@dataclass(frozen=True)
class Loops:
    """The closed loops (1)."""

    W: Complex  # (L, C + 1), m
    V: Complex  # (L, K, C + 1)

    def at(self, y: Samples) -> tuple[Samples, Samples, Samples]:
        """F, (n, 2 L), and its Jacobian, (n, 2 L, C + K), by the angles and displacements y; and the arms' lengths."""
        C = self.W.shape[1] - 1
        u, s = np.exp(1j * np.pad(y[:, :C], ((0, 0), (1, 0)))), y[:, C:]
        arms = self.W + np.einsum("lkc,nk->nlc", self.V, s)
        F = np.einsum("nlc,nc->nl", arms, u)
        J = np.concatenate([1j * arms[..., 1:] * u[:, np.newaxis, 1:], np.einsum("lkc,nc->nlk", self.V, u)], axis=2)
        return np.hstack([F.real, F.imag]), np.hstack([J.real, J.imag]), np.abs(arms[..., 1:])

    def bend(self, arms: Samples, rho: Samples) -> Samples:
        """By how much the Jacobian differs at most within rho, (n, C + K), of where the arms are, (n, 2 L, C + K)."""
        C, V = self.W.shape[1] - 1, np.abs(self.V[..., 1:])
        slid = np.einsum("lkc,nk->nlc", V, rho[:, C:])
        turned = (arms + slid) * rho[:, np.newaxis, :C] + slid
        bend = np.concatenate([turned, np.einsum("lkc,nc->nlk", V, rho[:, :C])], axis=2)
        return np.hstack([bend, bend])


def poses(equations: GroupEquations, placed: FramePoses, drive: float) -> tuple[Samples, bool]:
    """All coordinates of a group, shape (poses, m), and whether it is proven that none is missed.

    `placed` are the frames that it hangs on, shape (frames,), and `drive` is the position of its drive, if it has one.
    """
    # Joints are S z + R u - s t u_carrier = 0: linear in the first points z, by the attitudes u of the frames. Rows of
    # `null` span the left null space of S for the unknown points (from the SVD); multiplied by them the points drop
    # out, and one row a closed loop is left, with constants of what is placed in column 0.
    b, p, carriers, joints, arms = equations.bodies, equations.pins, equations.on, equations.S, equations.R
    shown = _attitudes(equations, placed)
    null = np.linalg.svd(joints[:, :b])[0][:, b:].conj().T  # of full rank: else a body would hang on nothing
    free = [k for k in range(len(carriers)) if k not in equations.driven]
    guides = -equations.along[:, np.newaxis] * shown[carriers]  # (s, C + 1)
    W = null @ arms @ shown
    W[:, 0] += null @ (joints[:, b:] @ placed.z)
    W += drive * null[:, p + equations.driven] @ guides[equations.driven]
    loops = Loops(W, null[:, [p + k for k in free]][..., np.newaxis] * guides[free])
    reach = np.abs(arms).sum() + np.abs(joints[:, b:] @ placed.z).sum() + abs(drive)
    angles = shown.shape[1] - 1
    y, complete = _zeros(loops, np.array([np.pi] * angles + [reach] * len(free)))
    u = np.exp(1j * np.pad(y[:, :angles], ((0, 0), (1, 0)))) @ shown.T
    s = np.full((len(y), len(carriers)), drive)
    s[:, free] = y[:, angles:]
    # The points belong to each zero by back-substitution: the joints are consistent there, so that least squares leaves
    # no residual.
    rest = u @ arms.T + joints[:, b:] @ placed.z
    rest[:, p:] -= s * equations.along * u[:, carriers]
    z = -np.linalg.lstsq(joints[:, :b], rest.T, rcond=None)[0].T
    return coordinates(z, np.angle(u[:, :b])), complete


def _attitudes(equations: GroupEquations, placed: FramePoses) -> Complex:
    """Each frame's attitude by the unknown angles, shape (frames, C + 1).

    Frames that joints keep parallel, or the drive at an angle, turn together, what is placed not at all.
    """
    b, frames, ties = equations.bodies, equations.S.shape[1], equations.A
    tied = np.abs(ties)
    tied[len(equations.on) :, -1] = 0  # not with the frame that stands for the drive
    joined = tied.T @ tied + np.eye(frames) > 0
    angles = np.linalg.lstsq(ties[:, :b], -ties[:, b:] @ placed.angle, rcond=None)[0]
    joined[b:, b:] = True
    placed_first = np.roll(np.arange(frames), frames - b)
    first = together(joined[np.ix_(placed_first, placed_first)])
    column = np.unique(first, return_inverse=True)[1][np.argsort(placed_first)]
    return np.asarray(np.eye(column.max() + 1)[column] * np.exp(1j * np.append(angles, placed.angle))[:, np.newaxis])


def together(joined: Any) -> NDArray[np.intp]:
    """The first of those that each is joined to, if by way of others, given which are joined; shape (n, n) to (n,)."""
    # Transitive closure of a boolean matrix: k squarings reach chains of 2^k links.
    for _ in range(len(joined).bit_length()):
        joined = joined @ joined
    return np.asarray(joined.argmax(axis=-1))


# Branch and bound: boxes of one size are divided along one unknown after another. A box is left out where the loops
# have no zero in it (`_may`), and decided where one zero is alone around it (`_alone`, Krawczyk's operator). It ends
# undecided where too many boxes are left at once, or where they are so small that two zeros meet in them.
def _zeros(loops: Loops, half: Samples) -> tuple[Samples, bool]:
    """The zeros of the loops within +-half, shape (zeros, U), and whether all boxes are decided."""
    middles = (2 * np.arange(PARTS) + 1) / PARTS - 1
    if PARTS ** len(half) > MAX_BOXES:
        return np.zeros((0, len(half))), False
    y, rho = np.array([*product(middles, repeat=len(half))]) * half, half / PARTS
    slack = ROUND_OFF_TOL * (np.abs(loops.W).sum() + np.abs(loops.V).sum() * half.max())
    zeros, level = np.zeros((0, len(half))), 0
    while len(y) and len(y) < MAX_BOXES and rho.max() > MIN_BOX * half.max():
        y = y[_may(loops, y, rho, slack)]
        roots, alone = _alone(loops, y, rho)
        here = alone & (np.abs(roots - y) <= rho * (1 + SAME_TOL)).all(axis=1)
        zeros = np.concatenate([zeros, roots[here]])
        y, axis = y[~alone], level % len(half)
        rho = np.where(np.arange(len(half)) == axis, rho / 2, rho)
        step = np.zeros(len(half))
        step[axis] = rho[axis]
        y, level = np.concatenate([y - step, y + step]), level + 1
    kept: list[Samples] = []
    for zero in zeros:
        apart = [np.abs(np.where(half == np.pi, np.angle(np.exp(1j * (zero - k))), zero - k)) for k in kept]
        if not any((distance <= SAME_TOL * half).all() for distance in apart):
            kept.append(zero)
    return np.array(kept).reshape(-1, len(half)), not len(y)


def _may(loops: Loops, y: Samples, rho: Samples, slack: float) -> Any:
    """Whether boxes may hold a zero, by F and its slope in their middles and by what that changes."""
    F, J, arms = loops.at(y)
    # Mean value form with a bound on the second-order term, half of what the Jacobian changes by within the box times
    # rho. It is tested row by row, and once more after multiplication by the inverse in the middle, which is sharp
    # where a row depends on several unknowns alike.
    bend = loops.bend(arms, np.broadcast_to(rho, y.shape)) @ rho / 2 + slack
    may = (np.abs(F) <= np.abs(J) @ rho + bend).all(axis=1)
    inverse = inverses(J)
    correction, more = np.abs(np.einsum("nij,nj->ni", inverse, F)), np.einsum("nij,nj->ni", np.abs(inverse), bend)
    return may & ~(correction > rho + more).any(axis=1)


def _alone(loops: Loops, y: Samples, rho: Samples) -> tuple[Samples, Any]:
    """The zeros that Newton's method leads to from the middles of boxes, and whether each is alone around its box."""
    root = y
    for _ in range(NEWTON_STEPS):
        F, J, arms = loops.at(root)
        root = root - np.einsum("nij,nj->ni", inverses(J), F)
    F, J, arms = loops.at(root)
    # Krawczyk's test on a box around the root that contains the whole given box: if |R F| and |R| times the change of J
    # map it into its inside, it has exactly one zero, and the given box has no other.
    inverse, around = inverses(J), np.abs(root - y) + rho
    correction = np.abs(np.einsum("nij,nj->ni", inverse, F))
    moved = np.einsum("nij,njk,nk->ni", np.abs(inverse), loops.bend(arms, around), around)
    return root, (correction + moved < around * (1 - SAME_TOL)).all(axis=1)
