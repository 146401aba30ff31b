"""Toggle press: all claims of Yang (2023); geometry, stroke and conclusions here, the others in files of their own."""

from collections.abc import Iterator, Sequence
from math import degrees, hypot, tau

import numpy as np

from compare.engines import registry
from compare.mechanics.motion_vectors import MotionVectors
from scenes import load

from ..claims import OPEN, Claim, comparison, judge, number, span
from .forces import claims as force_claims
from .kinematics import POSITIONS, RATES
from .presses import PART, PATHS, Press, family, press, rounded
from .table_1 import CRANK, HEIGHT, TOGGLE, column, virtual_work
from .variables import LENGTHS, over_two_turns

SOURCE = "toggle press"
SCENES = ("toggle_press", "crank_press")
L0, L1, L2, L3, L4, L5 = LENGTHS
P1_X, P1_Y = 404.709, 872.339  # mm, as printed


def claims() -> Iterator[Claim]:
    """Every row of this source."""
    variables = over_two_turns()
    for equation in (*POSITIONS, *RATES):
        yield judge(equation, variables, variables.scale)
    yield from force_claims()
    corners, crank = rounded(), press("crank_press")
    toggle = corners[0]
    yield from _geometry(toggle, corners)
    yield from column(TOGGLE, toggle, corners)
    yield from column(CRANK, crank, [crank])
    yield from virtual_work(toggle, corners)
    yield from _conclusions(toggle, crank)


def _geometry(toggle: Press, corners: Sequence[Press]) -> Iterator[Claim]:
    """The rows of the lowest pose, in which O, P3, P4 and P5 should be on the y axis, and P1, P2, P3 in line."""
    low = L1 + L3 + L5
    from_o, from_lowest = hypot(P1_X, P1_Y + L1), hypot(P1_X, P1_Y - low + L1)
    yield number(
        "geometry, P1-P3 with O as the origin of P1 [mm]",
        f"{L2 - L0:.0f}",
        from_o,
        among_printed=True,
        corrected=(f"the slider's lowest point, {low:g} mm below O, as its origin", from_lowest),
        note="l₂ − l₀, since P1, P2 and P3 are in line when the slider is lowest; both origins are printed",
    )
    x, y = (L2 / from_lowest * part for part in (P1_X, P1_Y - low + L1))  # from P3 to P2
    closure = hypot(x, y + L3)
    yield number(
        "geometry, P2-P4 when the slider is lowest [mm]",
        f"{L4:.0f}",
        closure,
        among_printed=True,
        note=f"the printed l₄ misses that pose by {L4 - closure:.2f} mm; P1 fits the other lengths to"
        f" {abs(from_lowest - L2 + L0):.0e} mm",
    )
    for what, off in zip(("P3 and P4 off the y axis", "P2 off the line P1-P3"), _off_lines(), strict=True):
        yield number(f"geometry, {what} when the slider is lowest [mm]", "0", off, among_printed=True, scale=L0)
    closed = press("toggle_press", {PATHS[4]: closure})
    yield number(
        "stroke [mm]",
        "180",
        1e3 * toggle.stroke,
        allowed=[span(1e3 * corner.stroke for corner in corners)],
        note=f"within the rounding of the lengths; {1e3 * closed.stroke:.1f} with the l₄ that closes the pose",
    )


def _off_lines() -> tuple[float, float]:
    """How far P3 or P4 is off the y axis, and P2 off the line P1-P3, where the slider is really lowest, mm."""
    scene = load("toggle_press")
    solve = registry.reference(scene)
    lowest, reach = 0.0, tau
    for _ in range(3):  # a grid of 0.2 deg, then two finer ones
        motion = solve(lowest + np.linspace(-reach, reach, 3601), np.zeros(3601))
        row = int(motion["P5.y"].argmin())
        lowest, reach = motion["crank_angle"][row], reach / 1000
    p1 = complex(*scene.ground["P1"])
    p2, p3 = (MotionVectors(scene, motion).point(point)[0][row] for point in ("P2", "P3"))
    axis = max(abs(motion[f"{point}.x"][row]) for point in ("P3", "P4"))
    return 1e3 * float(axis), 1e3 * float(abs(((p2 - p3) / (p1 - p3)).imag * abs(p1 - p3)))


def _conclusions(toggle: Press, crank: Press) -> Iterator[Claim]:
    """Each claim in words, against the crank press, for both directions in which the crank may turn."""
    reference = crank.before.at(HEIGHT)[1]
    shares = {way: side.at(HEIGHT)[1] / reference for way, side in toggle.closing.items()}
    lower = [share < 1 for share in shares.values()]
    speed = f"{' or '.join(f'{100 * share:.0f} % ({way})' for way, share in shares.items())} of the crank press's"
    yield comparison(
        "conclusion 1, low speed where the nominal force begins", "lower than the crank press's", lower, speed
    )
    closing = {way: degrees(side.angle[-1]) for way, side in toggle.closing.items()}
    ways = (f"closes in {angle:.1f}° and returns in {360 - angle:.1f}° ({way})" for way, angle in closing.items())
    yield comparison(
        "conclusion 2, quick return",
        "returns faster than it closes",
        [angle > 180 for angle in closing.values()],
        " or ".join(ways),
        "the direction is not given",
    )
    yield comparison(
        "conclusion 3, dwell at the lowest point",
        "stays there for long",
        [toggle.dwell > crank.dwell],
        f"within 1 % of the stroke for {360 * toggle.dwell:.1f}° of a turn, the crank press {360 * crank.dwell:.1f}°",
    )
    yield comparison(
        "conclusion 4, torque at nominal force",
        "smaller than the crank press's",
        lower,
        speed,
        "without friction and inertia the torque is the force times the speed over the crank's, hence the same ratio",
    )
    ratio = 1e3 * toggle.stroke / L0
    yield comparison(
        "introduction, large stroke from a small crank",
        "larger than a crank press's",
        [ratio > 2],
        f"{ratio:.3f} times the crank's radius, a crank press 2",
    )
    least, most = span(1e3 * member.stroke for _, member in family())
    yield comparison(
        "introduction, curves for different rod lengths",
        "announced, neither lengths nor curves given",
        OPEN,
        f"stroke {least:.1f} to {most:.1f} mm with one length {100 * PART:g} % longer or shorter",
    )
