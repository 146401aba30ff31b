"""A linkage as MuJoCo's model: bodies that move freely in the plane or slide on others, pins and drive as constraints.

A slider is a child of what it slides on, with its displacement as its one coordinate; any other body has the place of
its frame's origin and its angle. Lengths are over the linkage's size, masses over the largest, and a cycle takes 2 pi,
so that no tolerance of MuJoCo's depends on units.
"""

from collections.abc import Iterator
from typing import Any

import mujoco
import numpy as np

from scenes import Failure, Status
from scenes.scene import GROUND

from ..coordinates.system import System

MIN_INERTIA = 1e-9  # of m l^2: MuJoCo has no body without one
IMPEDANCE = 0.9999  # MuJoCo's limit; a joint's softness is the rest of it, times what its bodies weigh at their joints
HARDER = 1e-4  # times the reciprocals of those weights: at 1, softness shows in accelerations near dead points
SOFT = 'solref="{time!r} 1" solimp="0.9 0.95 0.001"'  # MuJoCo's defaults
SOFT_TIME = 0.02  # s, of them


class MujocoUnits:
    """What MuJoCo's numbers are over: the linkage's size, and these."""

    def __init__(self, linkage: System) -> None:
        self.mass = max(body.mass for body in linkage.bodies.values())  # kg
        self.second = linkage.scene.cycle / (2 * np.pi)  # s
        self.force = self.mass * linkage.size / self.second**2  # N


def model(linkage: System, h: float, *, hard: bool = True) -> Any:
    """MuJoCo's model for steps of h cycles over 2 pi, which close the gaps, or with its defaults for constraints."""
    scene, units = linkage.scene, MujocoUnits(linkage)
    # A negative solref is stiffness and damping themselves: k = 1/h^2 and b = 1/h close a gap within a step. The
    # impedance is the same at both ends of its width, so that it does not depend on the gap.
    holds = f'solref="{-(h**-2)!r} {-1 / h!r}" solimp="{IMPEDANCE} {IMPEDANCE} 1"'
    holds = holds if hard else SOFT.format(time=SOFT_TIME / units.second)
    pins = "".join(f'<connect site1="{p.second}:{p.point}" site2="{p.first}:{p.point}" {holds}/>' for p in scene.pins)
    g = _space(complex(*(scene.gravity or (0, 0))) * units.second**2 / linkage.size)
    drive = f'<joint joint1="{linkage.coordinates_of(linkage.drive.body)[-1]}" {holds}/>'
    compiled: Any = mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="radian" boundmass="0"/><option timestep="{h!r}" gravity="{g}" jacobian="dense"'
        ' tolerance="1e-14" iterations="200"><flag contact="disable" autoreset="disable"/></option>'
        f"<worldbody>{''.join(_content(linkage, units, GROUND))}</worldbody><equality>{pins}{drive}</equality></mujoco>"
    )
    if hard:
        # MuJoCo derives a constraint's compliance from these weights and the impedance, whose limit is 0.9999. Scaled
        # down, they make the compliance smaller than that limit allows.
        compiled.body_invweight0[:] *= HARDER
        compiled.dof_invweight0[:] *= HARDER
    return compiled


def _content(linkage: System, units: MujocoUnits, parent: str) -> Iterator[str]:
    """Yield the elements in a body or the ground: its sites, and the bodies that are its children."""
    for (body, point), arm in linkage.arms.items():
        if body == parent:
            yield f'<site name="{body}:{point}" pos="{_space(arm / linkage.size)}"/>'
    for name, rigid in linkage.bodies.items():
        guide = linkage.guides.get(name)
        if (GROUND if guide is None else guide.carrier) != parent:
            continue
        if rigid.mass == 0:
            raise Failure(Status.unsupported, f"'{name}' has no mass, and MuJoCo moves no body without")
        mass = rigid.mass / units.mass
        inertia = float(max(rigid.inertia / (units.mass * linkage.size**2), MIN_INERTIA * mass))
        if not min(inertia, mass) > mujoco.mjMINVAL:
            raise Failure(Status.unsupported, f"'{name}' is too light for MuJoCo beside the heaviest body")
        place, axes = 0j, [("slide", "1 0 0"), ("slide", "0 1 0"), ("hinge", "0 0 1")]
        if guide is not None:
            place, axes = (guide.through - guide.first) / linkage.size, [("slide", _space(guide.along))]
        named = zip(linkage.coordinates_of(name), axes, strict=True)
        joints = (f'<joint name="{joint}" type="{kind}" axis="{axis}"/>' for joint, (kind, axis) in named)
        moments = f'diaginertia="{inertia!r} {inertia!r} {inertia!r}"'
        weight = f'<inertial pos="{_space(rigid.com / linkage.size)}" mass="{mass!r}" {moments}/>'
        content = "".join((*joints, weight, *_content(linkage, units, name)))
        yield f'<body name="{name}" pos="{_space(place)}">{content}</body>'


def _space(vector: complex) -> str:
    return f"{float(vector.real)!r} {float(vector.imag)!r} 0"
