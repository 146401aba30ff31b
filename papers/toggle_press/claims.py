"""Toggle press: all claims of Yang (2023), of which the equations and table 1 have files of their own; its pictures."""

from collections.abc import Iterator, Sequence
from math import degrees, hypot

import numpy as np

from compare.engines import registry
from compare.mechanics.motion_vectors import MotionVectors
from compare.report.figures.figure import Figure, draw, stacked
from compare.report.figures.style import DASHES, GREY, colour, layout, marker
from scenes import load
from scenes.model.inputs import passing
from scenes.model.motion import Samples

from ..claims import UNDECIDED, Claim, comparison, judge, number, span
from .forces import claims as force_claims
from .kinematics import LENGTHS, POSITIONS, RATES, over_two_turns, scale_of
from .table_1 import HEIGHT, MAX_STROKES, PART, PATHS, Press, Side, entries, family, lowest, press, rounded, speed

SOURCE = "toggle press"
SCENES = ("toggle_press", "crank_press")
L0, L1, L2, L3, L4, L5 = LENGTHS
P1_X, P1_Y = 404.709, 872.339  # mm, as printed


def claims() -> Iterator[Claim]:
    """Every row of this source."""
    variables = over_two_turns()
    for equation in (*POSITIONS, *RATES):
        yield judge(equation, variables, scale_of(variables))
    yield from force_claims()
    corners, crank = rounded(), press("crank_press")
    toggle = corners[0]
    yield from _geometry(toggle, corners)
    yield from entries(toggle, crank, corners)
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
    for gap, distance in zip(("P3 and P4 off the y axis", "P2 off the line P1-P3"), _off_lines(), strict=True):
        yield number(f"geometry, {gap} when the slider is lowest [mm]", "0", distance, among_printed=True, scale=L0)
    closed = press("toggle_press", {PATHS[4]: closure})
    yield number(
        "stroke [mm]",
        "180",
        1e3 * toggle.stroke,
        allowed=[span(1e3 * corner.stroke for corner in corners)],
        note=f"within the rounding of the lengths; {1e3 * closed.stroke:.1f} with the l₄ that closes the pose",
    )


# Both are zero in the paper's lowest pose. The true lowest point is where the slider's velocity vanishes, solved by the
# reference; a distance from the line P1-P3 is the cross product of two vectors over the length of that line.
def _off_lines() -> tuple[float, float]:
    """How far P3 or P4 is off the y axis, and P2 off the line P1-P3, where the slider is really lowest, mm."""
    scene = load("toggle_press")
    motion = registry.reference(scene)(passing(scene, [lowest(scene)], [0.0]))
    p1 = complex(*scene.ground["P1"])
    p2, p3 = (MotionVectors(scene, motion).point(point)[0][0] for point in ("P2", "P3"))
    axis = max(abs(motion[f"{point}.x"][0]) for point in ("P3", "P4"))
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
        UNDECIDED,
        f"stroke {least:.1f} to {most:.1f} mm with one length {100 * PART:g} % longer or shorter",
    )


STRIDE = 10  # of the presses' samples: a degree of the crank


def figures() -> Iterator[tuple[str, str, Figure]]:
    """Yield title, note and figure of every picture."""
    yield (
        "Toggle press against crank press: the slider over a turn",
        f"From where each slider is lowest, as the crank turns; {MAX_STROKES} strokes a minute."
        " Circles: 6 mm above it.",
        _presses(),
    )
    yield (
        "Toggle press: one length 1 % longer or shorter",
        "Height of the slider above its lowest point. Solid: longer; dashed: shorter; grey: as printed.",
        _family(),
    )


def _presses() -> Figure:
    toggle, crank = press("toggle_press"), press("crank_press")
    sides = {
        "toggle press, clockwise": (toggle.after, toggle.before),
        "toggle press, counter-clockwise": (toggle.before, toggle.after),
        "crank press": (crank.before, crank.after),
    }
    figure = stacked(1, 1)
    for place, (name, (closing, opening)) in enumerate(sides.items()):
        angles, heights, speeds = _over_the_turn(closing, opening)
        angle, rate = closing.at(HEIGHT)
        line, circle = {"color": colour(place), "width": 1.8}, marker(place, "circle-open", 9)
        for row, values, there in ((1, heights, 1e3 * HEIGHT), (2, speeds, -speed(rate))):
            draw(figure, name, angles, values, row, line=line)
            above = f"{name}, 6 mm above"
            draw(figure, above, [-degrees(angle)], [there], row, group=name, mode="markers", marker=circle)
    figure.update_yaxes(title="height [mm]", panel=1)
    figure.update_yaxes(title="speed [mm/s]", panel=2)
    figure.update_xaxes(dtick=60)
    figure.update_xaxes(title="crank angle from the lowest point [deg]", panel=2)
    return figure.update_layout(layout(560))


def _over_the_turn(closing: Side, opening: Side) -> Iterator[Samples]:
    """The crank's angles, deg, and the slider's heights, mm, and speeds, mm/s."""
    yield np.degrees(np.concatenate([-closing.angle[::-STRIDE], opening.angle[::STRIDE]]))
    yield 1e3 * np.concatenate([closing.height[::-STRIDE], opening.height[::STRIDE]])
    yield speed(1.0) * np.concatenate([-closing.rate[::-STRIDE], opening.rate[::STRIDE]])


def _family() -> Figure:
    figure = stacked()

    def add(name: str, run: Press, line: dict[str, object]) -> None:
        angles, heights, _ = _over_the_turn(run.before, run.after)
        draw(figure, name, angles, heights, line={"width": 1.5} | line)

    add("as printed", press("toggle_press"), {"color": GREY, "width": 3})
    for place, (name, member) in enumerate(family()):
        add(name, member, {"color": colour(place // 2), "dash": DASHES[1 - place % 2]})
    figure.update_yaxes(title="height [mm]")
    figure.update_xaxes(title="crank angle from the lowest point, counter-clockwise [deg]", dtick=60)
    return figure.update_layout(layout(560))
