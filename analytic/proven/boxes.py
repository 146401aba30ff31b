"""A scene's recorded formulas over boxes of the drive's range: what goes into the line, and what comes out of it.

At a constant speed boxes divide the drive's positions, under a motion law the instants of its pieces, so that what a
rate or an acceleration leaps over where two pieces meet lies on the edge of a box, and both its limits in one.
"""

from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from copy import copy
from functools import partial, reduce
from itertools import zip_longest
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from scenes import Scene
from scenes.arguments import known_names
from scenes.channels import TRANSMISSION, own_channel
from scenes.drive import ConstantSpeed, DriveLaw, Driven
from scenes.laws import Piece
from scenes.model.motion import Samples

from ..channels import all_channels
from ..core.decomposition import decompose
from ..core.groups.group_equations import Group
from ..recorded.arithmetics.box_line import BoxLine
from ..recorded.arithmetics.systems import stacked
from ..recorded.arithmetics.taylor_models import TaylorModel, joined, parabola_most, point
from ..recorded.chained import depth, two_bars
from ..recorded.expressions import Expression
from ..recorded.program import inputs_at, inputs_of, recorded
from ..recorded.traced import Traced
from ..solve import prepared
from ..way.windings import attitudes
from .branches import ROOM, Branches, branches

FIRST_BOXES = 64  # of a range, before any is divided
LAST_PLACE = 2.0**-52  # of a number of the file, which was rounded when it was read and when it became SI
LAW_TOL = 2.0**-44  # of the terms of a motion law, whose numbers come of sums and of a spline's equations
STROKE, PARTS, STROKE_LEVELS = 512, 64, 3  # boxes of a cycle, parts of a box, levels: how a stroke's end is found
BLOCK = 512  # boxes of which the models are found at a time, so that they stay in cache
MAX_BOXES, SLOWER = 8000, 5  # boxes at a time, which take seconds; with larger groups a box takes some times as long
MAX_TIGHT, MAX_ALONE = (
    3,
    16,
)  # dyads that hang on each other: of more bounds grow, of still more so far that they tell nothing
MAX_WAYS = 27  # in which three joints may move or rest; more are too many
Numbers: TypeAlias = NDArray[np.intp]


class Boxes:
    """The channels and magnitudes of a scene over boxes, and the conditions under which they are so, for many calls."""

    def __init__(
        self, scene: Scene, names: AbstractSet[str] | None, off: Mapping[str, float], *, chain: bool | None = None
    ) -> None:
        """Prepare it.

        Args:
            scene: the mechanism.
            names: which channels and magnitudes; None for all.
            off: by how much numbers of the scene may be off, SI, by path in the file.
            chain: whether dyads of two bars are one system; None where more groups hang on each other than bear bounds
                of bounds.
        """
        self.scene, self.like, whole = scene, 3 + len(off), decompose(scene)
        self.law = whole.drive.law
        self.edges = cycle_edges(self.law, 0, 1)
        self.way = float(np.ptp(self.edges))  # of a cycle
        angles = [own_channel(group.P, TRANSMISSION) for group in whole.groups if not isinstance(group, Group)]
        parts, channels = {**scene.channels.magnitudes, TRANSMISSION: angles}, None
        if names is not None:
            every = {*parts, *(name for names_of, _ in all_channels(scene, whole.groups) for name in names_of)}
            known_names("names", names, every)
            channels = frozenset(part for name in names for part in parts.get(name, [name]))
        self.core = prepared(scene, whole, channels)
        linkage = self.core.linkage
        hanging = depth(linkage) if len(two_bars(linkage)) > 1 and not linkage.tracks else 0
        self.chained = hanging > MAX_ALONE if chain is None else chain
        self.grows = not self.chained and hanging > MAX_TIGHT
        self.program = recorded(scene, scene.numbers.keys(), channels, proven=True, chain=self.chained)
        make, rows = self.program.make, dict(self.program.channels)
        for name, parts_of in parts.items():
            if parts_of and rows.keys() >= {*parts_of}:
                expressions, least = [rows[part] for part in parts_of], partial(make, "minimum")
                rows[name] = reduce(least, expressions) if name == TRANSMISSION else abs(Traced(make, *expressions)).x
        self.names = [name for name in rows if names is None or name in names]
        units = [scene.channels[name].unit for name in self.names]
        self.kinds: Numbers = np.unique([unit.partition("*")[0] for unit in units], return_inverse=True)[1]
        self.arms = np.array([self.core.linkage.arm if unit == "N*m" else 1.0 for unit in units])  # of moments, m
        self.most = MAX_BOXES // SLOWER if self.core.linkage.tracks else MAX_BOXES
        turning = [body for body, channels in scene.channels.bodies.items() if channels.angle in rows]
        self.windings = {**self.core.windings, **attitudes(scene, self.core.linkage, turning)}
        self.numbers: dict[str, TaylorModel] = {}
        for path, number in scene.numbers.items():
            known = self.numbers[path] = point(number.value, self.like, LAST_PLACE * abs(number.value))
            if path in off:
                known.c[3 + [*off].index(path)] = off[path]
        for group, track in self.core.linkage.tracks.items():
            self.numbers[inputs_of(group)[2]] = point(track.branch, self.like)
        groups = self.program.closed.values()
        self.poses = [make.component(closing, i) for closing in groups for i in range(len(closing.of[0].coordinates))]
        self.branches: Branches | None = None
        if self.poses:
            poses_over = partial(self._over, BoxLine(self.poses, self.like, self.numbers, room=ROOM))
            self.branches = branches(poses_over, self.divided(FIRST_BOXES), self.most, periodic=self.law.periodic)
        for place, (displacement, _) in self.program.strokes.items():
            self.numbers[place] = self._stroke_end(displacement, scene.presses[place].closing)
        self._line = self._line_of([*(rows[name] for name in self.names), *self.program.conditions.values()])
        self._choices = self._line_of([*self.program.make.choices.values()])

    def __call__(self, low: Samples, high: Samples) -> tuple[TaylorModel, Numbers]:
        """The models of what is named and of the conditions, shape (rows, n), over boxes by their ends, shape (m,).

        With them which box each is of, shape (n,): one in which a press force may come or go, or a joint with friction
        may turn back, is there several times, once for each way.
        """
        given, box = self.given(low, high), np.arange(len(low))
        if self.program.make.choices:
            made, box = _chosen(self._over(self._choices, low, high, given))
            given = {name: values[box] for name, values in given.items()}
            given |= {name: made[row] for row, name in enumerate(self.program.make.choices)}
        return self._over(self._line, low[box], high[box], given), box

    def over(self, first: int, last: int) -> "Boxes":
        """The same of the cycles from one number to another, the first being 0."""
        others = copy(self)
        others.edges = cycle_edges(self.law, first, last)
        return others

    def divided(self, count: int) -> tuple[Samples, Samples]:
        """At least so many boxes a cycle, none over two pieces of a law: their ends, shape (n,)."""
        parts = np.ceil(count * np.diff(self.edges) / self.way).astype(int)
        pieces = zip(self.edges[:-1], self.edges[1:], parts, strict=True)
        ends = [np.linspace(low, high, n + 1) for low, high, n in pieces]
        return np.concatenate([edges[:-1] for edges in ends]), np.concatenate([edges[1:] for edges in ends])

    def _line_of(self, rows: Sequence[Expression]) -> BoxLine:
        """The line that has rows, and the poses of larger groups."""
        return BoxLine([*rows, *self.poses], self.like, self.numbers)

    def _over(
        self, line: BoxLine, low: Samples, high: Samples, given: Mapping[str, TaylorModel] | None = None
    ) -> TaylorModel:
        """The models of a line's rows, all of all boxes; none where a larger group may be on another branch."""
        given, parts = given or self.given(low, high), []
        for first in range(0, len(low), BLOCK):
            here = {name: values[first : first + BLOCK] for name, values in given.items()}
            boxes = point(np.zeros(len(here["position"].rest)), self.like)
            parts.append(stacked([*line(here), boxes]))
        every = joined(parts)[:-1]
        if self.branches is not None:
            rows, poses = (every[part] for part in np.split(np.arange(len(every.rest)), [-len(self.poses)]))
            known = self.branches.have(poses, low, high) | ~np.isfinite(poses.rest).any(axis=0)
            every = TaylorModel(rows.c, np.where(known, rows.rest, np.nan))
        return every

    # Branch and bound on one row: a box counts if its largest value may be above the largest value that is known to be
    # attained. Numbers of the scene that may be off move all boxes alike: only the difference of their slopes
    # (coefficients from 3 on) to the best box's is counted against a box, and the result keeps these slopes.
    def _stroke_end(self, displacement: Expression, closing: int) -> TaylorModel:
        """How far a cycle takes a slider in its closing direction, m: the most of boxes that may be the furthest."""
        line = self._line_of([displacement])
        low, high = self.divided(STROKE)
        for _ in range(STROKE_LEVELS):
            models = self._over(line, low, high)
            c, rest = closing * models.c[:, 0], models.rest[0]
            top, error = parabola_most(c), rest + LAST_PLACE * np.abs(c).sum(axis=0)
            known = np.where(np.isnan(error), -np.inf, top - error)
            best = int(known.argmax())
            further = np.abs(c[3:] - c[3:, [best]]).sum(axis=0)
            near = ~(top + error + further < known[best])
            most = np.max((top + error + further)[near])
            low, high = cut(low[near], high[near], PARTS)
        end = point((known[best] + most) / 2, self.like, (most - known[best]) * (0.5 + LAST_PLACE) + LAST_PLACE)
        end.c[3:] = c[3:, [best]]
        return TaylorModel(closing * end.c, end.rest)

    def given(self, low: Samples, high: Samples) -> dict[str, TaylorModel]:
        """The inputs of the line over boxes."""
        middle = (low + high) / 2
        way = point(middle, self.like)
        way.c[1] = np.maximum(high - middle, middle - low)
        law = self.law
        # At a constant speed the line's variable is the position, and the time follows from it; with a law it is the
        # time, and position, rate and acceleration follow from its piece.
        if isinstance(law, ConstantSpeed):
            given = {"position": way, "time": (way - self.numbers["drive.start"]) / self.numbers["drive.speed"]}
            state = Driven(middle, np.ones(()), np.zeros(()))
        else:
            given = {**driven(law, way, middle)._asdict(), "time": way}
            state = law.at(middle)
        wound = {name: point(winding(state.position), self.like) for name, winding in self.windings.items()}
        return {**given, **self._guesses(state, low, high), **wound}

    def _guesses(self, state: Driven, low: Samples, high: Samples) -> dict[str, TaylorModel]:
        """Where Newton's method begins in larger groups: in the middle of a box and at its ends, by what is near."""
        law, constant = self.law, isinstance(self.law, ConstantSpeed)
        ends = (end if constant else law.at(end).position for end in (low, high))
        places = np.concatenate([state.position, *ends])
        several, found = (
            inputs_at(state._replace(position=places), [self.core.linkage.tracks]),
            dict[str, TaylorModel](),
        )
        for name in several.keys() - {*Driven._fields}:
            # A parabola through middle and ends. Where Newton's method has nothing near at one of the three, another's
            # value stands in: a guess only decides where the iteration begins, no bound rests on it.
            three = np.broadcast_to(np.ravel(several[name]), len(places)).reshape(3, len(low))
            known = np.take_along_axis(three, np.isnan(three).argmin(axis=0)[np.newaxis], axis=0)
            middle, first, last = np.where(np.isnan(three), known, three)
            found[name] = point(middle, self.like)
            found[name].c[1:3] = (last - first) / 2, (last + first) / 2 - middle
        return found


def cut(low: Samples, high: Samples, parts: int) -> tuple[Samples, Samples]:
    """Boxes cut into equal parts, by their ends, shape (n,), with nothing left between: shape (parts n,)."""
    ends = low + (high - low) * (np.arange(parts + 1)[:, np.newaxis] / parts)
    ends[-1] = high
    return ends[:-1].ravel(), ends[1:].ravel()


def _chosen(numbers: TaylorModel) -> tuple[TaylorModel, Numbers]:
    """Enumerate the whole numbers that each row may take in each box; return them, and the box of each.

    A row with more than `MAX_WAYS` candidates keeps its bounds.
    """
    # Copies of a box are numbered in mixed radix: row by row, the number of candidates is the base of a digit, and
    # `slower` is the product of the bases before it. A row that is decided in all copies becomes a constant without a
    # rest.
    least, most = np.ceil(numbers.range[0]), np.floor(numbers.range[1])
    ways = np.where(np.isnan(most), 1, most - least + 1).astype(int)
    ways[:, ways.prod(axis=0) > MAX_WAYS] = 1
    box = np.repeat(np.arange(ways.shape[1]), ways.prod(axis=0))
    copy, slower = np.arange(len(box)) - np.searchsorted(box, box), np.cumprod(ways, axis=0) // ways
    values = least[:, box] + copy // slower[:, box] % ways[:, box]
    known = ((ways > 1) | (most == least))[:, box]
    c = np.where(known, 0.0, numbers.c[:, :, box])
    c[0] = np.where(known, values, c[0])
    return TaylorModel(c, np.where(known, 0.0, numbers.rest[:, box])), box


def cycle_edges(law: DriveLaw, first: int, last: int) -> Samples:
    """The ends of a drive's cycles from one number to another, and of a law's pieces, shape (n,), increasing.

    They are positions of the drive, rad or m, or instants, s, between which all is smooth but for what depends on
    bodies.
    """
    cycles = np.arange(first, last + 1)
    if isinstance(law, ConstantSpeed):
        return np.sort(law.after(cycles))
    begins = np.add.outer(law.cycle * cycles[:-1], [piece.begin for piece in law.pieces])
    return np.append(begins, law.cycle * last)


def driven(law: DriveLaw, way: TaylorModel, middle: Samples) -> Any:
    """The position, rate and acceleration that a law asks for over boxes of instants, each within one of its pieces."""
    pieces: Sequence[Piece] = law.pieces  # type: ignore[union-attr]
    cycles = np.floor(middle / law.cycle) if law.periodic else np.zeros(len(middle))
    before = law.cycle * cycles
    # Boxes never straddle two pieces (see `cycle_edges`), so the middle decides for the whole box.
    index = np.searchsorted([piece.begin for piece in pieces], middle - before, side="right") - 1

    def each(values: Sequence[float], error: float = LAW_TOL) -> Any:
        known = np.array(values)[index]
        return point(known, len(way.c), error * np.abs(known))

    begin = each([piece.begin for piece in pieces], len(pieces) * LAST_PLACE)  # a sum of as many durations at most
    begin = point(begin.c[0] + before, len(way.c), begin.rest + len(pieces) * LAST_PLACE * before)
    polynomial = [each(terms) for terms in zip_longest(*(piece.polynomial for piece in pieces), fillvalue=0.0)]
    several: Any = zip_longest(*(piece.sines for piece in pieces), fillvalue=(0.0, 0.0, 0.0))
    sines = [tuple(each(values) for values in zip(*each_one, strict=True)) for each_one in several]
    state: Any = Piece(begin, polynomial, sines, each([piece.lag for piece in pieces], 0.0)).at(way)  # type: ignore[arg-type]
    if not cycles.any():
        return state
    first, last = law.after([0, 1])
    gained = point(cycles * (last - first), len(way.c), LAW_TOL * np.abs(cycles) * (abs(first) + abs(last)))
    return state._replace(position=state.position + gained)
