"""A scene as MuJoCo's model: bodies that move freely in the plane or slide on others, pins and drive as constraints.

A slider is a child of what it slides on, with its displacement as its one coordinate; any other body has the place of
its frame's origin and its angle. Lengths are over the linkage's size, masses over the largest, and a cycle takes 2 pi,
so that no tolerance of MuJoCo's depends on units.
"""

from collections.abc import Iterator
from typing import Any, NamedTuple, TypeAlias

import mujoco
import numpy as np
from numpy.typing import NDArray

from scenes import Failure, Scene, Status
from scenes.motion import Samples
from scenes.scene import GROUND

from ..coordinates.bodies import FramedBody, framed_body, linkage_size

Plane: TypeAlias = NDArray[np.complex128]
LEAST_INERTIA = 1e-9  # of m l^2: MuJoCo has no body without one
IMPEDANCE = 0.9999  # MuJoCo's limit; a joint's softness is the rest of it, times what its bodies weigh at their joints
HARDER = (
    1e-4  # times the reciprocals of those weights: at 1, softness shows in accelerations near a toggle's dead point
)
SOFT = 'solref="{time!r} 1" solimp="0.9 0.95 0.001"'  # MuJoCo's defaults
SOFT_TIME = 0.02  # s, of them


class Moving(NamedTuple):
    """What one body does, each of shape (n,): its frame's origin, m, and angle, rad, and their two derivatives."""

    z: Plane
    angle: Samples
    dz: Plane
    omega: Samples
    ddz: Plane
    alpha: Samples

    def at(self, local: complex) -> tuple[Plane, Plane, Plane]:
        """Return place, velocity and acceleration of a point of its frame."""
        arm = local * np.exp(1j * self.angle)
        turning = 1j * self.alpha - self.omega**2
        return self.z + arm, self.dz + 1j * self.omega * arm, self.ddz + turning * arm


class Linkage:
    """The model of one scene, whose constraints close gaps within a step, h, or are MuJoCo's defaults."""

    def __init__(self, scene: Scene) -> None:
        """Find bodies and units.

        Raises:
            Failure: see `coordinates.bodies`; `unsupported`, a body has no mass.
        """
        self.scene = scene
        self.bodies = {name: _heavy(framed_body(scene, body), name) for name, body in scene.bodies.items()}
        self.size = linkage_size(scene, self.bodies)
        self.mass = max(body.mass for body in self.bodies.values())
        self.second = scene.drive.cycle / (2 * np.pi)
        self.force = self.mass * self.size / self.second**2
        self.drive_unit = 1.0 if scene.driven_slide is None else self.size
        self.coordinates = [name for body in scene.bodies for name in self._names(body)]
        self.units = np.array([1.0 if name.endswith(".turn") else self.size for name in self.coordinates])

    def local(self, body: str, point: str) -> complex:
        """Return a point in the frame of its body or of the ground, m."""
        return complex(*(self.scene.ground[point] if body == GROUND else self.bodies[body].points[point]))

    def guide(self, body: str) -> tuple[str, complex, complex, complex]:
        """Return a slider's carrier, a point and the direction of its guide there, and its first point in its own."""
        held = self.scene.bodies[body]
        assert held.slide is not None
        first = self.local(body, held.points[0])
        return held.slide.on, complex(*held.slide.through), complex(*held.slide.along), first

    def slides(self, body: str) -> bool:
        """Return whether a body slides."""
        return body != GROUND and self.scene.bodies[body].slide is not None

    def model(self, h: float, *, hard: bool = True) -> Any:
        """Return MuJoCo's model for steps of h cycles over 2 pi; `order` takes its coordinates to ours."""
        holds = f'solref="{-(h**-2)!r} {-1 / h!r}" solimp="{IMPEDANCE} {IMPEDANCE} 1"'
        holds = holds if hard else SOFT.format(time=SOFT_TIME / self.second)
        pins = "".join(
            f'<connect site1="{pin.second}:{pin.point}" site2="{pin.first}:{pin.point}" {holds}/>'
            for pin in self.scene.pins
        )
        g = _space(complex(*(self.scene.gravity or (0, 0))) * self.second**2 / self.size)
        drive = f'<joint joint1="{self._names(self.scene.drive.body)[-1]}" {holds}/>'
        model: Any = mujoco.MjModel.from_xml_string(
            f'<mujoco><compiler angle="radian" boundmass="0"/><option timestep="{h!r}" gravity="{g}" jacobian="dense"'
            ' tolerance="1e-14" iterations="200"><flag contact="disable" autoreset="disable"/></option>'
            f"<worldbody>{''.join(self._content(GROUND))}</worldbody><equality>{pins}{drive}</equality></mujoco>"
        )
        if hard:
            model.body_invweight0[:] *= HARDER
            model.dof_invweight0[:] *= HARDER
        return model

    def order(self, model: Any) -> NDArray[np.intp]:
        """Return where MuJoCo has our coordinates."""
        return np.array([int(model.joint(name).qposadr[0]) for name in self.coordinates])

    def moving(self, q: Samples, v: Samples, a: Samples) -> dict[str, Moving]:
        """Return what all bodies do, from coordinates and their derivatives, SI, each of shape (n, coordinates)."""
        still, here = np.zeros(len(q)), np.zeros(len(q), np.complex128)
        found = {GROUND: Moving(here, still, here, still, here, still)}
        while len(found) <= len(self.bodies):
            for name in self.bodies:
                if name in found or (self.slides(name) and self.guide(name)[0] not in found):
                    continue
                columns = [self.coordinates.index(of) for of in self._names(name)]
                (x, *other), (dx, *rates), (ddx, *changes) = (of[:, columns].T for of in (q, v, a))
                if not self.slides(name):
                    (y, angle), (dy, omega), (ddy, alpha) = other, rates, changes
                    found[name] = Moving(x + 1j * y, angle, dx + 1j * dy, omega, ddx + 1j * ddy, alpha)
                    continue
                carrier, through, along, first = self.guide(name)
                on = found[carrier]
                turn = np.exp(1j * on.angle)
                arm = turn * (through + along * x - first)
                found[name] = Moving(
                    on.z + arm,
                    on.angle,
                    on.dz + 1j * on.omega * arm + turn * along * dx,
                    on.omega,
                    on.ddz + (1j * on.alpha - on.omega**2) * arm + turn * along * (ddx + 2j * on.omega * dx),
                    on.alpha,
                )
        return found

    def _names(self, body: str) -> list[str]:
        """Return the names of a body's coordinates; that which may be driven is the last."""
        return [f"{body}.s"] if self.slides(body) else [f"{body}.x", f"{body}.y", f"{body}.turn"]

    def _content(self, parent: str) -> Iterator[str]:
        """Yield the elements in a body or the ground: its sites, and the bodies that are its children."""
        points = self.scene.ground if parent == GROUND else self.bodies[parent].points
        for point in points:
            yield f'<site name="{parent}:{point}" pos="{_space(self.local(parent, point) / self.size)}"/>'
        for name, body in self.bodies.items():
            if (self.guide(name)[0] if self.slides(name) else GROUND) != parent:
                continue
            inertia = float(max(body.inertia / (self.mass * self.size**2), LEAST_INERTIA * body.mass / self.mass))
            if not min(inertia, body.mass / self.mass) > mujoco.mjMINVAL:
                raise Failure(Status.unsupported, f"'{name}' is too light for MuJoCo beside the heaviest body")
            if self.slides(name):
                _, through, along, first = self.guide(name)
                place, axes = (through - first) / self.size, {"s": ("slide", _space(along))}
            else:
                place = 0j
                axes = {"x": ("slide", "1 0 0"), "y": ("slide", "0 1 0"), "turn": ("hinge", "0 0 1")}
            joints = (f'<joint name="{name}.{c}" type="{kind}" axis="{axis}"/>' for c, (kind, axis) in axes.items())
            about = f'diaginertia="{inertia!r} {inertia!r} {inertia!r}"'
            weight = (
                f'<inertial pos="{_space(complex(*body.com) / self.size)}" mass="{body.mass / self.mass!r}" {about}/>'
            )
            content = "".join((*joints, weight, *self._content(name)))
            yield f'<body name="{name}" pos="{_space(place)}">{content}</body>'


def _heavy(body: FramedBody, name: str) -> FramedBody:
    """Return a body that MuJoCo can move.

    Raises:
        Failure: `unsupported`, it has no mass.
    """
    if body.mass == 0:
        raise Failure(Status.unsupported, f"'{name}' has no mass, and MuJoCo moves no body without")
    return body


def _space(vector: complex) -> str:
    return f"{float(vector.real)!r} {float(vector.imag)!r} 0"
