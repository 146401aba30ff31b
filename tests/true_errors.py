"""How far a motion is off the truth, by nothing of the comparison's: every vector's distance as DESIGN.md defines it.

The error of a vector is its distance over the larger of its scale and its true magnitude there: T w and T w^2 for
points, w and w^2 for bodies, the peak of its joint for a force. A place is relative to the travel T of its point, the
largest distance between two of its positions, but at least a hundredth of the linkage's largest; an angle to 1 rad.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

import analytic
from scenes import Failure, Motion, Sampling, Scene
from scenes.channels import Role
from scenes.fields import put, walk
from scenes.model.motion import Samples
from scenes.scene import GROUND, Force, PressForce

from . import absolute_coordinates
from .absolute_friction import SEVERAL, SLOW, JammedError, unsure
from .agreement import exact
from .remainder_scenes import PREFIX, strongest

SAMPLES = 720  # a cycle: fine enough for peaks to 1e-5 of themselves
FEW = 72  # a cycle, where friction jams at some instants: for peaks of the others
HAIR = 1e-6  # of a slider's range and peak speed: nearer to a press force's switch, it may or may not act
TURNING = 1e-3  # of its peak speed, where it turns round: the way left goes with the square of the speed
CANCELLED = 16 * np.finfo(float).eps  # of the largest force: what doubles leave where it cancels, by some ten terms
NOTHING = 1e-12  # of the largest force: a joint that carries no more carries nothing but round-off
DRIVE = "drive"
LAST_PLACES = 4 * np.finfo(float).eps  # of every number
DRAWS = 8  # of scenes that are so far off
FIXED = ("frequencies", "times")  # instants that are off do the same

Channels = Mapping[str, Samples]
Reals = NDArray[np.floating[Any]]
Vectors = NDArray[np.complexfloating[Any, Any]]
Rows = NDArray[np.bool_]


def by_core(scene: Scene, time: Samples) -> Channels:
    """Return the motion by the analytic core, for many samples; `by_absolute` holds it."""
    return analytic.solve(scene, scene.drive.law.at(time).position, time).samples


def by_absolute(scene: Scene, time: Samples) -> Channels:
    """Return the motion in absolute coordinates: nothing of the core's, a few milliseconds a sample."""
    return absolute_coordinates.solve(scene, *scene.drive.law.at(time), time)


@dataclass(frozen=True)
class Rubbed:
    """A motion with friction in absolute coordinates."""

    channels: Channels  # NaN where it jams
    fates: Sequence[str]  # by row: `moves`, `jammed` or `undetermined`
    unsure: Rows  # where the sense of some friction is not known, so that nobody is held to the forces

    @classmethod
    def of(cls, scene: Scene, time: Samples) -> "Rubbed":
        drive, model, rows, fates, slow = scene.drive.law.at(time), absolute_coordinates.Absolute(scene), [], [], []
        none = {name: np.nan for name in scene.channels.names() if name != "time"}
        for now in absolute_coordinates.instants(model, *drive, time):
            slow.append(unsure(model, now))
            try:
                rows.append(model.channels(now))
                fates.append("undetermined" if rows[-1].get(SEVERAL) else "moves")
            except JammedError:
                rows.append(none)
                fates.append("jammed")
        rests = np.array(slow) | (np.abs(drive.rate) <= SLOW * scene.drive.law.peak_rate)
        return cls({name: np.array([row[name] for row in rows]) for name in none}, fates, rests & bool(scene.friction))


@dataclass(frozen=True)
class Truth:
    """The true motion of a scene, and what errors are relative to."""

    scene: Scene
    solve: Callable[[Scene, Samples], Channels] = by_core
    known: dict[Sampling, Rubbed] = field(default_factory=dict)
    fifty: dict[Sampling, Channels] = field(default_factory=dict)  # motions by 50 digits

    def rubbed(self, sampling: Sampling) -> Rubbed:
        """Return the motion of a scene with friction."""
        if sampling not in self.known:
            self.known[sampling] = Rubbed.of(self.scene, sampling.times(self.scene))
        return self.known[sampling]

    def fates(self, sampling: Sampling) -> str:
        """Return what friction does at some instants, `jammed` or `undetermined` or both."""
        fates = self.rubbed(sampling).fates if self.scene.friction else ()
        return " ".join(sorted({*fates} - {"moves"}))

    @property
    def is_remainder(self) -> bool:
        """Whether doubles leave more of it than a promise, so that 50 digits are the truth."""
        return self.scene.name.startswith(PREFIX)

    def by_fifty(self, sampling: Sampling) -> Channels:
        """Return the motion by 50 digits."""
        if sampling not in self.fifty:
            self.fifty[sampling] = exact(self.scene, sampling).samples
        return self.fifty[sampling]

    def left(self, sampling: Sampling) -> dict[str, Samples]:
        """Return by vector what all numbers, and the instants, being four last places off make of it, shape (n,).

        At a single sample the few draws may all but cancel: each has the largest of its own and of both beside it.
        """
        time, chance, found = sampling.times(self.scene), np.random.default_rng(1), dict[str, Samples]()
        numbers = {number.at: number.value for number in walk(self.scene) if number.at[-2] not in FIXED}
        for _ in range(DRAWS):
            off = 1 + LAST_PLACES * chance.choice((-1.0, 1.0), len(numbers))
            other = put(self.scene, dict(zip(numbers, off * [*numbers.values()], strict=True)))
            position = self.scene.drive.law.at(time).position * off[0]
            moved = analytic.solve(other, position, time * off[-1]).samples
            for name, error in self._errors(moved, self.by_fifty(sampling)):
                found[name] = np.maximum(found.get(name, 0.0), error)
        return {name: maximum_filter1d(error, 3) for name, error in found.items()}

    def errors(self, motion: Motion, sampling: Sampling) -> dict[str, Samples]:
        """Return the errors of a motion by vector, shape (n,); on a press force's switch on the side that fits best.

        Of a small remainder they are those above what last places leave.
        """
        if self.is_remainder:
            found, left = dict(self._errors(motion.samples, self.by_fifty(sampling))), self.left(sampling)
            return {name: np.where(error <= left[name], 0.0, error) for name, error in found.items()}
        time = sampling.times(self.scene)
        true = self.rubbed(sampling).channels if self.scene.friction else self.solve(self.scene, time)
        found = dict(self._errors(motion.samples, true))
        rows = self._switches(time, true)
        for scene in self._sides() if rows.any() else ():
            at_rows = {channel: values[rows] for channel, values in motion.samples.items()}
            there = dict(self._errors(at_rows, self.solve(scene, time[rows])))
            better = sum(there.values()) < sum(error[rows] for error in found.values())
            for name, error in there.items():
                found[name][rows] = np.where(better, error, found[name][rows])
        for name in {name for name, _ in self._forces(true)} & found.keys() if self.scene.friction else ():
            found[name][self.rubbed(sampling).unsure] = 0.0
        return found

    @cached_property
    def _cycle(self) -> Channels:
        try:
            return by_core(self.scene, Sampling(SAMPLES).times(self.scene))
        except Failure:  # it jams somewhere
            rubbed = self.rubbed(Sampling(FEW))
            moves = np.array(rubbed.fates) != "jammed"
            return {name: values[moves] for name, values in rubbed.channels.items()}

    @property
    def _presses(self) -> list[PressForce]:
        return [load for load in self.scene.loads if isinstance(load, PressForce)]

    def _sides(self) -> Iterator[Scene]:
        """Yield the scene with press forces that each act always or never."""
        for way in product((True, False), repeat=len(self._presses)):
            acts = dict(zip(self._presses, way, strict=True))
            loads = [load for load in self.scene.loads if not isinstance(load, PressForce) or acts[load]]
            always = (Force(load.body, load.at, load.force) if isinstance(load, PressForce) else load for load in loads)
            yield replace(self.scene, loads=tuple(always))

    def _switches(self, time: Samples, true: Channels) -> Rows:
        """Return at which instants rounding decides whether a press force acts."""
        switches = np.zeros(time.shape, np.bool_)
        for load in self._presses:
            x, v, _ = self._displacement(load, true)
            way, speed, change = self._displacement(load, self._cycle)
            last = way.argmax()
            dead_point = 0 < last < SAMPLES  # near, and beyond this sample
            end = way[last] + (speed[last] ** 2 / (2 * np.abs(change[last])) if dead_point else 0.0)
            near, turns = HAIR * np.ptp(way), np.abs(v) / np.abs(speed).max()
            switches |= (np.abs(end - x - load.last) <= near) | (turns <= HAIR)
            switches |= (np.abs(end - x) <= near) & (turns <= TURNING)
        return switches

    def _displacement(self, load: PressForce, motion: Channels) -> tuple[Reals, Reals, Reals]:
        """Return how far the pressed slider is towards the end of its stroke, m, and its first two derivatives."""
        body = self.scene.bodies[load.body]
        assert body.slide is not None
        along, through = load.closing * complex(*body.slide.along).conjugate(), complex(*body.slide.through)
        z, v, a = (_vector(motion, f"{body.points[0]}.{of}") for of in ("", "v", "a"))
        return ((z - through) * along).real, (v * along).real, (a * along).real

    @cached_property
    def _travels(self) -> dict[str, float]:
        """Return the travel of each moving point, m."""
        paths = {point: _vector(self._cycle, f"{point}.") for point in self.scene.moving_points}
        own = {point: float(np.abs(path[:, None] - path).max()) for point, path in paths.items()}
        return {point: max(travel, max(own.values()) / 100) for point, travel in own.items()}

    def _reach(self, channel: str) -> float:
        """Return the largest travel of the points of both bodies of a guide, m."""
        body = self.scene.bodies[channel.partition(".")[0]]
        assert body.slide is not None
        points = [p for name in (body.name, body.slide.on) if name != GROUND for p in self.scene.bodies[name].points]
        return max(self._travels.get(point, 0.0) for point in points)

    @cached_property
    def _drive(self) -> tuple[float, float]:
        """Return the drive's travel, m or rad, and its rate, travels a second."""
        least, most = self.scene.drive.law.extent
        travel = 1.0 if self.scene.drive.slide is None else most - least
        return travel, self.scene.drive.law.peak_rate / travel

    @cached_property
    def _peaks(self) -> dict[str, float]:
        """Return what forces and moments are relative to; a guide's moment at least to its force times the travel."""
        peaks = {name: float(np.abs(force).max()) for name, force in self._forces(self._cycle)}
        for name in peaks:
            if name.endswith("guide_moment"):
                peaks[name] = max(peaks[name], self._reach(name) * peaks[name.replace("moment", "force")])
        largest = max(*peaks.values(), strongest(self.scene, self._cycle)) or 1.0
        return {name: peak if peak > NOTHING * largest else largest for name, peak in peaks.items()}

    def _forces(self, motion: Channels) -> Iterator[tuple[str, Vectors]]:
        yield from ((pin.channel, _vector(motion, f"{pin.channel}.f")) for pin in self.scene.pins)
        for name in (name for name, body in self.scene.bodies.items() if body.slide is not None):
            yield from ((of, motion[of] + 0j) for of in (f"{name}.guide_force", f"{name}.guide_moment"))
        effort = "drive.torque" if self.scene.drive.slide is None else "drive.force"
        yield from ((of, motion[of] + 0j) for of in (effort, *self.scene.channels.names(Role.friction)))

    def _errors(self, motion: Channels, true: Channels) -> Iterator[tuple[str, Samples]]:
        scene, (travel, w) = self.scene, self._drive
        yield DRIVE, np.abs(motion[scene.channels.drive.position] - true[scene.channels.drive.position]) / travel
        for point in scene.moving_points:
            z, there = (_vector(of, f"{point}.") for of in (motion, true))
            own = self._travels[point]
            yield point, np.abs(z - there) / own
            for name, scale in ((f"{point}.v", own * w), (f"{point}.a", own * w**2)):
                yield name, _mixed(_vector(motion, name), _vector(true, name), scale)
        for body in scene.turning:
            turned = motion[f"{body}.angle"] - true[f"{body}.angle"]
            yield f"{body}.angle", np.abs(np.angle(np.exp(1j * turned)))
            for name, scale in ((f"{body}.omega", w), (f"{body}.alpha", w**2)):
                yield name, _mixed(motion[name] + 0j, true[name] + 0j, scale)
        if scene.has_masses:
            forces = [(*of, there) for of, (_, there) in zip(self._forces(motion), self._forces(true), strict=True)]
            others = "moment", "torque", "power"
            largest = np.max([np.abs(there) for name, _, there in forces if not name.endswith(others)], axis=0)
            for name, force, there in forces:
                left = CANCELLED * self._arm(name) * largest / np.maximum(self._peaks[name], np.abs(there))
                error = _mixed(force, there, self._peaks[name])
                yield name, np.where(error <= left, 0.0, error)

    def _arm(self, channel: str) -> float:
        """Return at which arm forces make a moment, m; one of a force."""
        if channel.endswith("guide_moment"):
            return self._reach(channel)
        if channel != "drive.torque":
            return 1.0
        drawn = [self.scene.drawn[point] for point in self.scene.bodies[self.scene.drive.body].points]
        return max(abs(one - other) for one in drawn for other in drawn)  # however small the stroke


def _vector(motion: Channels, stem: str) -> Vectors:
    return motion[f"{stem}x"] + 1j * motion[f"{stem}y"]


def _mixed(vector: Vectors, true: Vectors, scale: float) -> Samples:
    error: Samples = np.abs(vector - true) / np.maximum(scale, np.abs(true))
    return error
