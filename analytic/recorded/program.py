"""The core's formulas for one topology as a straight line of real expressions, recorded from the core itself.

A larger group is a pose found by Newton's method, its rates, and the forces of its joints. The constraints are those of
`group_equations`. Their Jacobian is their derivative, and the rates are derivatives of the pose, by the implicit
function theorem.
"""

from collections.abc import Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from functools import cached_property, partial, reduce
from math import inf
from operator import mul
from typing import Any

import numpy as np

from scenes import Sampling, Scene
from scenes.drive import Driven, Samples
from scenes.scene import GROUND, ConstantSpeed

from ..channels import all_channels, asked, of_larger
from ..core.decomposition import Linkage, decompose
from ..core.dyads import bounded_rrr_position, rrr_position
from ..core.elements import acts, wound
from ..core.groups.continuation import Track
from ..core.groups.group_equations import Group, equations_of, size_of
from ..core.kinematics import Pass
from ..core.kinetostatics import Reactions
from ..core.numbers import chosen
from ..core.placing import RRRPosition
from ..way.windings import attitude
from .arithmetics.in_numpy import StraightLine
from .balances import BoundedBalance, RecordedBalance, continued
from .chained import balanced, chained
from .expressions import Closing, Expression, Inputs, Recorder, forward
from .traced import Traced, traced


@dataclass(frozen=True)
class Program:
    """Channels as expressions of numbers of the scene, SI, by path, and of what the drive asks for."""

    make: Recorder
    request: Sampling  # with the channels wanted
    scene: Scene  # with numbers as expressions
    linkage: Linkage  # with the same
    closed: Mapping[Group, Expression]  # the larger groups' coordinates
    channels: Mapping[str, Expression]
    strokes: Mapping[str, tuple[Expression, Expression]]  # by press force: its slider's displacement, m, and rate
    conditions: Mapping[str, Expression]  # by what does not close where it is negative, or else may be closed twice
    loads: Mapping[str, Traced]  # by place in the file, of those that are forces
    own: frozenset[str]  # channels wanted that are left to the core: how far larger groups are from a singular pose

    @cached_property
    def reach(self) -> Expression:
        """The least of the conditions; of a crank alone, which always reaches, infinite."""
        return reduce(partial(self.make, "minimum"), self.conditions.values(), self.make.constant(inf))

    @cached_property
    def reaches(self) -> StraightLine | None:
        """How far each dyad reaches, of block after block of machines; None where there are no dyads."""
        dyads = [self.conditions[group.P] for group in self.linkage.groups if not isinstance(group, Group)]
        return StraightLine(dyads) if dyads else None

    @cached_property
    def rows(self) -> list[Expression]:
        """The channels, and the reach last."""
        return [*self.channels.values(), self.reach]

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The channels wanted, with the time and the drive's position, in the order of the files."""
        known = self.request.wanted(self.scene)
        return (*known, *(name for name in (*self.channels, *self.own) if name not in known))


@np.errstate(all="ignore")  # of constants, as of samples
def recorded(
    scene: Scene,
    paths: AbstractSet[str],
    channels: AbstractSet[str] | None = None,
    *,
    proven: bool = False,
    chain: bool = False,
) -> Program:
    """Record the core's own formulas of some channels, in which the numbers at `paths` stay open.

    Where it is to be `proven` what they are, as an arithmetic of bounds takes them; dyads that hang on each other in a
    `chain` as one system.
    """
    make = Recorder(proven=proven)
    numbers = {path: Traced(make, make.input(path, sampled=False)) for path in scene.numbers if path in paths}
    opened = scene.with_numbers(numbers)
    every = decompose(opened)
    request, linkage = asked(scene, every, channels)
    channels = request.channels
    driven: Any = Driven(*(Traced(make, make.input(name, sampled=True)) for name in Driven._fields))  # type: ignore[arg-type]
    if isinstance(opened.drive.law, ConstantSpeed):
        driven = driven._replace(rate=traced(make, opened.drive.law.speed), acceleration=traced(make, 0.0))
    way = RecordedPass(make, opened, linkage, driven, rrr=bounded_rrr_position if proven else rrr_position)
    k = chained(make, opened, linkage, driven, way.by_time) if chain else way.solve().k
    on, loads = Reactions(), dict[str, Traced]()
    strokes: dict[str, tuple[Expression, Expression]] = {}
    if request.wants_forces(scene):
        for place, load in scene.presses.items():
            s, ds, _ = (traced(make, x).x for x in k.displaced(opened, scene.bodies[load.body].points[0]))
            strokes[place] = s, ds
        given: Any = {name: Traced(make, make.input(name, sampled=False)) for name in strokes}
        given |= {name: Traced(make, make.input(name, sampled=True)) for name in ("position", "time", *wound(scene))}
        if chain and not scene.friction:
            balance: RecordedBalance = balanced(make, opened, linkage, given, k)
            on = balance.reactions
        else:
            balance = (BoundedBalance if proven else RecordedBalance)(opened, linkage, given, k)
            on = balance.solve()
        loads = {
            f"loads.{number}": traced(make, next(acts(load, f"loads.{number}", balance))[1].force)
            for number, load in enumerate(opened.loads)
            if not (proven or load.is_moment)
        }
    of_core = of_larger(linkage.groups)
    expressions: dict[str, Expression] = {}
    for names, take in all_channels(scene, linkage.groups):
        wanted = {name for name in names if channels is None or name in channels}
        if wanted and of_core.isdisjoint(wanted):
            value = traced(make, take(k, on))
            parts = zip(names, (value.x, value.y), strict=False)
            expressions |= {name: part for name, part in parts if name in wanted}
    for body, rates in scene.channels.bodies.items() if proven else ():
        if rates.angle in expressions:
            rough = Traced(make, make.input(attitude(body), sampled=True))
            expressions[rates.angle] = traced(make, continued(rough, k.u[body])).x
    branches = ((f"the branch of {group.P}", group.branch) for group in every.groups if not isinstance(group, Group))
    # A branch is zero where the sketch leaves it open.
    drawn = {name: chosen(branch * branch > 0, 1.0, -1.0) for name, branch in branches if isinstance(branch, Traced)}
    conditions = {name: traced(make, condition).x for name, condition in (k.reach | drawn).items()}
    left = of_core if channels is None else of_core & channels
    return Program(make, request, opened, linkage, way.closed, expressions, strokes, conditions, loads, left)


def inputs_at(driven: Driven, tracks: Sequence[Mapping[Group, Track]]) -> Inputs:
    """The inputs of a line that are no numbers of the scene, at positions (n,), or (m, n) of machines' own tracks."""
    given: dict[str, Samples | float] = {**driven._asdict()}
    for group in tracks[0] if tracks else ():
        begin, allowed, branch = inputs_of(group)
        each = np.broadcast_to(driven.position, (len(tracks), driven.position.shape[-1]))
        guesses = [tracks_of[group].guess(position) for tracks_of, position in zip(tracks, each, strict=True)]
        given |= zip(begin, np.moveaxis(np.array([guess for guess, _ in guesses]), -1, 0), strict=True)
        given[allowed] = np.array([off for _, off in guesses])
        given[branch] = np.array([[tracks_of[group].branch] for tracks_of in tracks])
    return given


def inputs_of(group: Group) -> tuple[list[str], str, str]:
    """The inputs of a group: where its method begins, how far off that it may end, its branch's sign of det J."""
    return [f"{body}.{q}" for body in group.bodies for q in ("x", "y", "angle")], f"{group.P}.off", f"{group.P}.branch"


class RecordedPass(Pass):
    """Places everything as expressions."""

    def __init__(
        self, make: Recorder, scene: Scene, linkage: Linkage, driven: Any, *, rrr: RRRPosition = rrr_position
    ) -> None:
        super().__init__(scene, linkage, driven, rrr=rrr)
        self.make = make
        self.closed: dict[Group, Expression] = {}
        self.by_time = {driven.position.x: driven.rate.x}
        if driven.rate.x.sampled:
            self.by_time[driven.rate.x] = driven.acceleration.x

    def larger(self, group: Group) -> None:
        """Place a larger group."""
        make, k = self.make, self.k
        begin, allowed, branch = inputs_of(group)
        unknowns = [make.input(f"{name} sought", sampled=True) for name in begin]
        closing = Closing(unknowns, *self.constraints(group, unknowns))
        size = traced(make, size_of(group, self.linkage.bodies)).x
        given = [*(make.input(name, sampled=True) for name in (*begin, allowed)), make.input(branch, sampled=False)]
        closed = self.closed[group] = make.closed(closing, [*given, size, *closing.outer])
        q = [make.component(closed, i) for i in range(len(begin))]
        closing.at_zero = self.constraints(group, q)
        dq = forward(make, q, self.by_time)
        ddq = forward(make, dq, self.by_time)
        k.jacobian[group.P] = closing.at_zero[1]  # type: ignore[assignment]
        # q <= q is false for NaN: the recorded test of whether Newton's method closed the group.
        a_number: Any = Traced(make, make("less_equal", q[0], q[0]))
        k.reach[group.P] = chosen(a_number, 1.0, -1.0)
        for b, body in enumerate(group.bodies):
            (z, v, a) = (Traced(make, x[3 * b], x[3 * b + 1]) for x in (q, dq, ddq))
            turn, omega, alpha = (Traced(make, x[3 * b + 2]) for x in (q, dq, ddq))
            foot = self.scene.bodies[body].points[0]
            if foot not in k.z:
                k.z[foot], k.v[foot], k.a[foot] = z, v, a  # type: ignore[assignment]
            self.place(body, foot, np.exp(1j * turn), (omega, alpha))  # type: ignore[arg-type]

    def constraints(self, group: Group, q: Sequence[Expression]) -> tuple[list[Expression], list[Expression]]:
        """Return C of a group, and its Jacobian J by the coordinates q, row by row."""
        places = [Traced(self.make, *q[row : row + 2]) for row in range(0, len(q), 3)]
        attitudes: list[Any] = [np.exp(1j * Traced(self.make, angle)) for angle in q[2::3]]
        for name in group.hangs_on:
            place, attitude = self.frame(name)
            places.append(traced(self.make, place))
            attitudes.append(traced(self.make, attitude))
        equations = equations_of(self.scene, self.linkage.bodies, group)
        C = [traced(self.make, row).x for row in equations.open(RecordedFrames(np.array(places), np.array(attitudes)))]
        # The Jacobian is differentiated from the constraints rather than written down a second time.
        columns = [forward(self.make, C, {coordinate: self.make.constant(1.0)}) for coordinate in q]
        return C, [entry for row in zip(*columns, strict=True) for entry in row]

    def frame(self, name: str) -> tuple[Any, Any]:
        """The place and the attitude of a frame that a group hangs on."""
        if name.startswith("/"):
            return self.driven.position, np.exp(1j * self.driven.position)
        if name.startswith("."):
            return self.k.z[name.removeprefix(".")], 1
        return self.fixed(name, 0 if name == GROUND else self.linkage.bodies[name].first)[0], self.k.u[name]


@dataclass(frozen=True)
class RecordedFrames:
    """Where frames are, as `FramePoses`: arrays of objects, of shape (frames,)."""

    z: Any
    u: Any

    def turned(self, A: Samples) -> Any:
        """The sines of sums of angles, which count 1, -1 or not at all, shape (t, frames): zero at whole turns."""
        return np.array([self._product(row).imag for row in A], object)

    def _product(self, row: Samples) -> Any:
        u = [(self.u[n] if count > 0 else self.u[n].conjugate()) for n, count in enumerate(row) if count]
        return reduce(mul, u)
