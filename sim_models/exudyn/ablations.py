"""What more than a scene needs costs: the same linkage with fewer coordinates, with bodies in space, or with extras.

With fewer, a body that only turns about a pin of the ground is a RotationalMass1D, one that slides on the ground a
Mass1D, and its joint with the ground is no constraint any more. All others are as before. The reactions of those joints
follow from the equations of motion of the whole system, M a + C_q^T lambda = f, in the rows of the body.
"""

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from shutil import rmtree
from tempfile import mkdtemp
from typing import Any, ClassVar
from weakref import finalize

import numpy as np

from scenes import Failure, Scene, Status
from scenes.joints import DriveJoint, Guide, Joint, Pin
from scenes.model.constraints import blocks
from scenes.scene import GROUND

from .drive import ExudynDrive
from .joints import RULES, TURN, ExudynGuide, ExudynJoint, ExudynPin
from .poses import PoseSolver
from .settings import ExudynExtra, TextbookTimeStepping, TimeStepping
from .system import Array, ExudynSystem, exudyn, items


class ReducedSystem(ExudynSystem):
    """A scene as an Exudyn system whose coordinates satisfy the ground's pins and guides where they can.

    `pivots` are the bodies that only turn about a pin of the ground, with that pin; `sliders` those that slide on the
    ground. One on which another slides stays as it is.
    """

    def __init__(self, scene: Scene, drive: ExudynDrive, *, si: bool = False) -> None:
        slides = scene.slides
        carriers = {slide.on for slide in slides.values()}
        pins = {name: [p for p in scene.pins if (p.first, p.second) == (GROUND, name)] for name in scene.bodies}
        self.pivots = {name: held[0] for name, held in pins.items() if len(held) == 1 and name not in slides}
        self.sliders = {name for name, slide in slides.items() if slide.on == GROUND and name not in carriers}
        self.reduced = self.pivots.keys() | self.sliders
        super().__init__(scene, drive, si=si)
        # By own coordinate the parts of x, y and angle of every body in it, but for constants.
        whole = zip(self.bodies, np.eye(3 * len(self.bodies)).reshape(len(self.bodies), 3, -1), strict=True)
        self._parts = np.concatenate([self._own_parts(name) @ planar for name, planar in whole])
        self.unknowns = len(self._parts)  # and as many multipliers

    def narrowed(self, q: Array) -> Array:
        """Return this system's coordinates from x, y and angle of every body, or their rates."""
        return np.asarray(self._parts @ q)

    def _own_parts(self, name: str) -> Array:
        if name in self.sliders:
            return np.array([[self.along(name).real, self.along(name).imag, 0.0]])
        return np.eye(3)[TURN:] if name in self.pivots else np.eye(3)

    def widened(self, samples: Array, poses: PoseSolver, times: Array) -> Array:
        """What a system of whole bodies would have recorded, shape (3 or 4, n, 3 bodies), from this one's."""
        wide = np.zeros((len(samples), len(times), 3 * len(self.bodies)))
        wide[:3] = samples[:3] @ self._parts
        # A body about a pivot of the ground has its angle alone: its centre of mass is at the arm from the pivot, with
        # the rate i omega r and the acceleration (i alpha - omega^2) r. A slider has its displacement, and the constant
        # offset of its guide.
        for name, x, y, turn in zip(self.bodies, *np.arange(3 * len(self.bodies)).reshape(-1, 3).T, strict=True):
            if name in self.pivots:
                angle, omega, alpha = wide[:3, :, turn]
                arm = -self._pivot(name) * np.exp(1j * angle)
                com = np.stack([arm, 1j * omega * arm, (1j * alpha - omega**2) * arm])
                wide[:3, :, x], wide[:3, :, y] = com.real, com.imag
            if name in self.reduced:
                wide[0, :, x] += self._origin(name).real
                wide[0, :, y] += self._origin(name).imag
        if len(samples) > 3:
            for rows in blocks(wide[0]):
                wide[3, rows] = self._all_multipliers(poses, wide[:3, rows], samples[3, rows], times[rows])
        return wide

    def _all_multipliers(self, poses: PoseSolver, motion: Array, multipliers: Array, times: Array) -> Array:
        """Those of all joints, shape (n, constraints): this system's own, and the others that the motion needs."""
        (q, v, a), whole, equations = motion, poses.system, poses.equations
        # C_q^T lambda = f - M a of the system with whole bodies: as many multipliers as coordinates, so that the square
        # matrix gives all of them. The system's own multipliers replace theirs where it has them, as those are what the
        # integration solved for.
        needed = equations.forces(q, v, times) - equations.masses * a
        every: Array = np.linalg.solve(equations.jacobian(q).swapaxes(1, 2), needed[..., np.newaxis])[..., 0]
        kept = [column for joint in self.joints for column in whole.columns(whole.joints[joint])]
        every[:, kept] = multipliers
        return every

    def _pivot(self, body: str) -> complex:
        """A body's pivot, from its centre of mass along its own axes, m."""
        return self.bodies[body].points[self.pivots[body].point]

    def _origin(self, body: str) -> complex:
        """A body's pivot on the ground, or a slider's centre of mass with its coordinate at zero."""
        if body in self.pivots:
            return complex(*self.scene.ground[self.pivots[body].point])
        normal = 1j * self.along(body)
        return normal * (normal.conjugate() * (complex(*self.scene.slides[body].through) - self.lever(body))).real

    def _add_body(self, name: str) -> Any:
        if name not in self.reduced:
            return super()._add_body(name)
        body, origin = self.bodies[name], self._origin(name)
        node = self.nodes[name] = self.mbs.AddNode(items.Node1D())
        place = {"nodeNumber": node, "referencePosition": [origin.real, origin.imag, 0]}
        if name in self.pivots:
            inertia = body.inertia + body.mass * abs(self._pivot(name)) ** 2
            return self.mbs.AddObject(items.ObjectRotationalMass1D(inertia=inertia, **place))
        x = self.along(name)  # it moves along its own x axis
        axes = [[x.real, -x.imag, 0], [x.imag, x.real, 0], [0, 0, 1]]
        return self.mbs.AddObject(items.ObjectMass1D(mass=body.mass, referenceRotation=axes, **place))

    def placed(self, body: str, place: complex) -> tuple[Any, list[float]]:
        """A body's object, and a place along the axes that it has here."""
        if body in self.pivots:
            place = place - self._pivot(body)
        elif body in self.sliders:
            place = place * self.along(body).conjugate()
        return super().placed(body, place)

    def coordinate(self, body: str, number: int) -> Any:
        """A marker on the one coordinate of a body, or on a coordinate, or on the ground's zero."""
        if body in self.sliders and number == TURN:
            return super().coordinate(GROUND, 0)
        return super().coordinate(body, 0 if body in self.reduced else number)


class SpatialPin(ExudynPin):
    """A pin in space."""

    def add(self, joint: Pin, system: ExudynSystem) -> Any:
        """Hold P2 - P1 at zero in x and y."""
        markers = [system.at(body, joint.point) for body in joint.between]
        return system.mbs.AddObject(items.SphericalJoint(markerNumbers=markers, constrainedAxes=[1, 1, 0]))


class SpatialGuide(ExudynGuide):
    """A guide in space, of the ground alone."""

    def on_body(self, joint: Guide, system: ExudynSystem) -> Any:  # noqa: ARG002
        """Refuse."""
        why = f"{joint.slider} slides on {joint.slide.on}, for which there is no joint in space here"
        raise Failure(Status.unsupported, why)


class SpatialSystem(ExudynSystem):
    """Rigid bodies with six coordinates, each held in the plane by itself, so that no joint of a loop is redundant."""

    rules: ClassVar[Mapping[type[Joint], ExudynJoint]] = {**RULES, Pin: SpatialPin(), Guide: SpatialGuide()}
    node_size = 6
    in_plane = (0, 1, 5)

    def __init__(self, scene: Scene, drive: ExudynDrive, *, si: bool = False) -> None:
        super().__init__(scene, drive, si=si)
        bodies = range(len(self.bodies))
        self.coordinates = np.array([6 * number + column for number in bodies for column in self.in_plane])
        # A pin in space has three multipliers, of which the third, out of the plane, is switched off; a body's
        # coordinates in the plane are 0, 1 and 5 of six.
        planar = (self.columns(held)[: joint.equations] for joint, held in self.joints.items())
        self.multipliers = np.array([column for columns in planar for column in columns])

    def narrowed(self, q: Array) -> Array:
        """All coordinates from x, y and angle of every body, or their rates."""
        all_coordinates = np.zeros(self.node_size * len(self.bodies))
        all_coordinates[self.coordinates] = q
        return all_coordinates

    def _add_body(self, name: str) -> Any:
        body = self.bodies[name]
        node = self.nodes[name] = self.mbs.AddNode(items.NodeRigidBodyRxyz())
        inertia = [body.inertia, body.inertia, body.inertia, 0, 0, 0]  # but for the last axis without effect
        return self.mbs.AddObject(items.ObjectRigidBody(mass=body.mass, inertia=inertia, nodeNumber=node))

    def add(self, joint: Joint) -> Any:
        """Add a joint; before the first drive all bodies are held in the plane."""
        first = next(joint for joint in self.scene.joints if isinstance(joint, DriveJoint))
        for name in self.bodies if joint == first else ():
            self.hold(name, np.eye(6)[2:5], [0.0, 0.0, 0.0])
        return super().add(joint)


def add_extras(system: ExudynSystem, options: TimeStepping, step: float, *, forces: bool) -> None:
    """Add sensors, text files or a callback to a system with steps of that size, s; files are deleted with it."""
    extra, solution = options.extra, system.settings.solution
    folder = None
    if extra is ExudynExtra.TEXT or isinstance(options, TextbookTimeStepping):
        folder = Path(mkdtemp(prefix="exudyn_"))
        finalize(system, rmtree, folder)
        solution.file.write = True  # as it is preset, but not into the working folder
        solution.file.name = str(folder / "coordinates.txt")
    if extra in (ExudynExtra.SENSORS, ExudynExtra.TEXT):
        solution.sensors.writePeriod = step
        for number, sensor in enumerate(_sensors(system, forces=forces)):
            file = str(folder / f"sensor{number}.txt") if folder and extra is ExudynExtra.TEXT else ""
            system.mbs.AddSensor(sensor(fileName=file, storeInternal=not file))
        system.mbs.Assemble()
    if extra is ExudynExtra.CALLBACK:
        system.mbs.SetPreStepUserFunction(lambda _mbs, _time: True)


def _sensors(system: ExudynSystem, *, forces: bool) -> Iterator[Callable[..., Any]]:
    """Yield a sensor for every two channels or one, as a function of where it writes."""
    scene, kinds = system.scene, exudyn.OutputVariableType
    motions = (kinds.Position, kinds.Velocity, kinds.Acceleration)
    turns = (kinds.Rotation, kinds.AngularVelocity, kinds.AngularAcceleration)
    places = [(scene.owners[point][0], point, motions) for point in scene.moving_points]
    for body, point, measured in [*places, *((name, "", turns) for name in scene.turning)]:
        place = system.bodies[body].points.get(point, 0j)
        place_of = {"bodyNumber": system.objects[body], "localPosition": [place.real, place.imag, 0]}
        yield from (partial(items.SensorBody, outputVariableType=kind, **place_of) for kind in measured)
    if forces:
        for joint, held in system.joints.items():
            kind = system.rules[type(joint)].sensed(joint, kinds)
            yield partial(items.SensorObject, objectNumber=held, outputVariableType=kind)
