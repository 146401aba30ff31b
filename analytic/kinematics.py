"""Position, velocity and acceleration of the whole linkage, group after group, for many crank angles at once."""

from dataclasses import dataclass, field, replace

import numpy as np

from scenes import Scene
from scenes.motion import Samples

from .continuation import follow
from .decomposition import RRP, RRR, Decomposition
from .dyads import Vectors, as_vectors, rrp_reach, rrr_position, rrr_rates, rrr_reach, turned
from .geometry import as_complex
from .newton_group import Complex, Group, rates


@dataclass(frozen=True)
class Kinematics:
    """Where everything is and how it moves. Arrays of shape (n,), or of shape () for what does not change."""

    z: dict[str, Vectors] = field(default_factory=dict)  # points: position, m
    v: dict[str, Vectors] = field(default_factory=dict)  # m/s
    a: dict[str, Vectors] = field(default_factory=dict)  # m/s^2
    u: dict[str, Vectors] = field(default_factory=dict)  # bodies: attitude exp(i angle)
    omega: dict[str, Samples] = field(default_factory=dict)  # rad/s
    alpha: dict[str, Samples] = field(default_factory=dict)  # rad/s^2
    rate: dict[str, Vectors] = field(default_factory=dict)  # i alpha - omega^2
    arms: dict[str, tuple[Vectors, Vectors, Samples]] = field(default_factory=dict)  # RRR by inner pin: p, q, p x q
    guide: dict[str, tuple[Samples, Samples]] = field(default_factory=dict)  # RRP by inner pin: p . t, p . n
    jacobian: dict[str, Samples] = field(default_factory=dict)  # larger group by its pin P: shape (n, m, m)
    reach: dict[str, Samples] = field(default_factory=dict)  # by inner pin: positive where the group can be assembled


def kinematics(scene: Scene, linkage: Decomposition, crank_angle: Samples) -> Kinematics:
    """Solve position, velocity and acceleration at the crank angles, shape (n,), rad.

    Where a group does not reach, its `reach` is negative and it and all that hangs on it are NaN.

    Raises:
        Failure: a larger group has no branch to follow, as `continuation.follow` says.
    """
    k = Kinematics()
    for point, xy in scene.ground.items():
        k.z[point], k.v[point], k.a[point] = np.array(as_complex(xy)), np.array(0j), np.array(0j)
    _crank(scene, linkage, k, crank_angle)
    for group in linkage.groups:
        if isinstance(group, RRR):
            _rrr(group, linkage, k)
        elif isinstance(group, RRP):
            _rrp(group, linkage, k)
        else:
            _larger(scene, group, linkage, k, crank_angle)
    return k


def _crank(scene: Scene, linkage: Decomposition, k: Kinematics, crank_angle: Samples) -> None:
    u = np.exp(1j * crank_angle)
    _place(linkage, k, linkage.crank.body, linkage.crank.pivot, u, np.array(scene.drive.speed), np.array(0.0))


def _rrr(dyad: RRR, linkage: Decomposition, k: Kinematics) -> None:
    A, B, P = dyad.A, dyad.B, dyad.P
    bar_1 = linkage.bodies[dyad.body_1].arm(A, P)
    bar_2 = linkage.bodies[dyad.body_2].arm(B, P)
    d = k.z[B] - k.z[A]
    distance = np.abs(d)
    k.reach[P] = rrr_reach(abs(bar_1), abs(bar_2), distance)
    p, q, area = k.arms[P] = rrr_position(d, distance, abs(bar_1), abs(bar_2), k.reach[P], dyad.branch)

    w1, w2 = rrr_rates(k.v[B] - k.v[A], p, q, area)
    centripetal = (k.a[B] - w2**2 * q) - (k.a[A] - w1**2 * p)
    alpha_1, alpha_2 = rrr_rates(centripetal, p, q, area)
    _place(linkage, k, dyad.body_1, A, p * (1 / bar_1), w1, alpha_1)
    _place(linkage, k, dyad.body_2, B, q * (1 / bar_2), w2, alpha_2)


def _rrp(dyad: RRP, linkage: Decomposition, k: Kinematics) -> None:
    """Solve in guide axes: P = C + s t on the slider, A + p on the bar; only s and the bar's angle are unknown."""
    A, P, t = dyad.A, dyad.P, dyad.t
    bar, slider = linkage.bodies[dyad.bar].arm(A, P), linkage.bodies[dyad.slider]
    C = dyad.through + slider.arm(dyad.first, P)
    e = (C - k.z[A]) * t.conjugate()
    k.reach[P] = rrp_reach(abs(bar), e.imag)
    p_t, p_n = k.guide[P] = dyad.branch * np.sqrt(k.reach[P]), e.imag

    v = k.v[A] * t.conjugate()
    omega = -v.imag / p_t
    a = k.a[A] * t.conjugate()
    alpha = (omega**2 * p_n - a.imag) / p_t

    k.z[P] = np.asarray(C + t * (p_t - e.real))
    k.v[P] = np.asarray(t * (v.real - omega * p_n))
    k.a[P] = np.asarray(t * (a.real - alpha * p_n - omega**2 * p_t))
    _place(linkage, k, dyad.slider, P, np.array(1 + 0j), np.array(0.0), np.array(0.0))
    _place(linkage, k, dyad.bar, A, as_vectors(p_t, p_n) * (t / bar), omega, alpha)


def _larger(scene: Scene, group: Group, linkage: Decomposition, k: Kinematics, crank_angle: Samples) -> None:
    if group not in linkage.tracks:
        before = replace(linkage, groups=linkage.groups[: linkage.groups.index(group)])
        linkage.tracks[group] = follow(
            scene, group, linkage.bodies, lambda angle: _placed_pins(group, kinematics(scene, before, angle), angle)
        )
    track = linkage.tracks[group]
    z, v, a = _placed_pins(group, k, crank_angle)
    q, J = track.at(crank_angle, z)
    dq, ddq = rates(track.equations, q, J, v, a)
    k.jacobian[group.P], k.reach[group.P] = J, np.where(np.isnan(q[:, 0]), -1.0, 1.0)

    equations = track.equations
    feet = equations.origin + equations.feet(q), equations.feet(dq), equations.feet(ddq)
    u, omega, alpha = equations.attitude(q), equations.angles(dq), equations.angles(ddq)
    for b, body in enumerate(group.bodies):
        foot = scene.bodies[body].points[0]
        if foot not in k.z:
            k.z[foot], k.v[foot], k.a[foot] = (x[:, b] for x in feet)
        _place(linkage, k, body, foot, u[:, b], omega[:, b], alpha[:, b])


def _placed_pins(group: Group, k: Kinematics, crank_angle: Samples) -> tuple[Complex, Complex, Complex]:
    """Return position, velocity and acceleration of what each pin hangs on, shape (n, j); zero within the group."""
    z, v, a = np.zeros((3, len(crank_angle), len(group.joints)), complex)
    for j, joint in enumerate(group.joints):
        if joint.on is None:
            z[:, j], v[:, j], a[:, j] = k.z[joint.point], k.v[joint.point], k.a[joint.point]
    return z, v, a


def _place(
    linkage: Decomposition, k: Kinematics, body: str, foot: str, u: Vectors, omega: Samples, alpha: Samples
) -> None:
    """Carry the body's own points along with its placed point `foot`."""
    rate = turned(omega, alpha)
    k.u[body], k.omega[body], k.alpha[body], k.rate[body] = u, omega, alpha, rate
    for point in linkage.carries[body]:
        if point not in k.z:
            r = u * linkage.bodies[body].arm(foot, point)
            k.z[point] = k.z[foot] + r
            k.v[point] = k.v[foot] + r * (1j * omega)
            k.a[point] = k.a[foot] + r * rate
