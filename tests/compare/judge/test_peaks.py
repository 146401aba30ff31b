"""The designer's numbers of the reference against formulas, geometry and energy written here."""

from collections.abc import Callable
from math import acos, asin, atan2, cos, pi, sin, sqrt, tau

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as some
from scipy.integrate import quad
from scipy.optimize import brentq, minimize_scalar

import analytic
from compare.judge.peaks.peaks import Peak, peaks
from compare.mechanics.reference import uncertified
from scenes import Sampling
from tests import scene_files
from tests.analytic.views import Change
from tests.comparisons import sampled
from tests.scene_files import NONE, Changes

DWELL = "dwell within 1 % of the stroke"
MOTION = frozenset(("P5.x", "P5.y", "P5.vx", "P5.vy"))


def numbers(name: str, changes: Changes = NONE, channels: frozenset[str] | None = None) -> dict[str, Peak]:
    reference = uncertified(scene_files.load(name, changes))
    return {peak.name: peak for peak in peaks(reference, Sampling(72, channels=channels), [])}


@pytest.mark.parametrize("rod", [250, 350])
def test_an_offset_crank_slider_by_its_formulas(rod: int) -> None:
    """Slider at x(a) = r cos a + sqrt(l^2 - (r sin a - e)^2), a = 4 pi t; dead where crank and rod are in line."""
    r, e, length, w = 0.1, 0.04, 1e-3 * rod, 4 * pi
    q = numbers("offset_slider_crank", {"bodies.rod.lengths.A-B": rod})

    def x(a: float) -> float:
        return r * cos(a) + sqrt(length**2 - (r * sin(a) - e) ** 2)

    outer, inner = sqrt((length + r) ** 2 - e**2), sqrt((length - r) ** 2 - e**2)
    assert q["stroke"].value == pytest.approx(outer - inner, rel=1e-10)
    out, back = asin(e / (length + r)), pi + asin(e / (length - r))  # crank angles of the dead points
    step = 2e-6  # rad: a thousandth of a sample's
    for name, end, angle in (("closed dead point", inner, back), ("open dead point", outer, tau + out)):
        assert q[name].value == pytest.approx(end + 0.02 - 0.015, rel=1e-10)  # of the output point, from `through`
        assert q[name].position == pytest.approx(angle, abs=step)  # from 25 deg on
    closing = back - out
    assert q["quick return"].value == pytest.approx(closing / (tau - closing), rel=1e-6)
    near = inner + 0.01 * (outer - inner)
    dwell = brentq(lambda a: x(a) - near, back, back + 1.5) - brentq(lambda a: x(a) - near, back - 1.5, back)
    assert q[DWELL].value == pytest.approx(dwell / w, rel=1e-9)  # the ends of the stroke to 1e-10, and the root

    def speed(a: float) -> float:
        s = r * sin(a) - e
        return -w * r * (sin(a) + s * cos(a) / sqrt(length**2 - s**2))

    def acceleration(a: float, h: float = 1e-5) -> float:
        return w * (speed(a + h) - speed(a - h)) / (2 * h)

    def torque(a: float) -> float:  # the massless crank and rod pass on the power of slider and load
        return speed(a) * (7 * acceleration(a) - 2000) / w

    def power(sense: int) -> Callable[[float], float]:
        return lambda a: max(sense * torque(a), 0.0)

    curves: dict[str, Callable[[float], float]] = {"peak speed": speed, "peak acceleration": acceleration}
    curves |= {"peak driving torque": power(1), "peak braking torque": power(-1)}
    curves |= {"peak driving power": lambda a: w * power(1)(a), "peak braking power": lambda a: w * power(-1)(a)}
    for name, curve in curves.items():
        at, largest = extreme(curve)
        largest *= -1 if "braking" in name else 1
        assert q[name].value == pytest.approx(largest, rel=1e-8)
        assert cos(q[name].position - at) == pytest.approx(1, abs=step**2)
        if "speed" in name or "acceleration" in name:
            assert q[name].direction == (0 if curve(at) > 0 else pytest.approx(pi))
    assert q["work a turn"].value == 0  # the load gives back what it took
    square = quad(lambda a: torque(a) ** 2, 0, tau, limit=200, epsrel=1e-10)[0] / tau
    assert q["RMS drive torque"].value == pytest.approx(sqrt(square), rel=1e-6)


def extreme(of: Callable[[float], float]) -> tuple[float, float]:
    """Return where the magnitude of a function is largest over one turn, and that."""
    guess = max(np.linspace(0, tau, 721).tolist(), key=lambda a: abs(of(a)))
    bounds = (guess - 0.01, guess + 0.01)
    best = minimize_scalar(lambda a: -abs(of(a)), bounds=bounds, method="bounded", options={"xatol": 1e-9})
    return float(best.x), -float(best.fun)


def test_a_slider_crank_in_line() -> None:
    """Crank 1, rod 3, at 10 rad/s; slider of 2 kg, pushed by 50 N towards the crank; no other masses."""
    q = numbers("slider_crank")
    assert q["stroke"].value == pytest.approx(2, rel=1e-12)
    assert q["quick return"].value == pytest.approx(1, rel=1e-9)
    assert (q["closed dead point"].value, q["open dead point"].value) == pytest.approx((4, 2), rel=1e-12)
    assert (q["closed dead point"].position, q["open dead point"].position) == pytest.approx((0, pi), abs=1e-6)
    assert q["peak acceleration"].value == pytest.approx(100 * (1 + 1 / 3), rel=1e-12)
    for pin in "OAB":  # 2 kg at that acceleration, less the load, towards the crank
        assert q[f"largest force at {pin}"].value == pytest.approx(2 * 400 / 3 - 50, rel=1e-12)
        assert abs(q[f"largest force at {pin}"].direction) == pytest.approx(pi)
        assert q[f"largest force at {pin}"].position == pytest.approx(0, abs=1e-6)
    assert abs(q["largest guide force at slider"].direction) == pytest.approx(pi / 2)
    assert q["largest guide moment at slider"].value == 0
    assert np.isnan(q["largest guide moment at slider"].position)
    least, lock = q["least transmission angle"], q["distance to a singular pose"]
    assert least.of == lock.of == "B"
    assert least.value == pytest.approx(acos(1 / 3), rel=1e-9)
    assert lock.value == pytest.approx(3 - 1, rel=1e-9)  # a rod as short as the crank
    assert abs(sin(least.position)) == abs(sin(lock.position)) == pytest.approx(1, rel=1e-12)


def test_the_toggle_press_by_its_geometry() -> None:
    """The points found here as intersections of circles."""

    def slider(a: float) -> complex:
        p2 = complex(0.404709, -0.217661) + 0.077 * np.exp(1j * a)
        p3 = circles(0j, 0.3, p2, 0.49, left=False)
        p4 = circles(p2, 0.76, p3, 0.49, left=True)
        return complex(p4.real, p4.imag - sqrt(0.3**2 - p4.real**2))

    q = numbers("toggle_press")
    at_top, top = extreme(lambda a: 2 + slider(a).imag)  # 2 m above, all are positive
    at_bottom, bottom = extreme(lambda a: 2 - slider(a).imag)
    assert q["stroke"].value == pytest.approx(top + bottom - 4, rel=1e-9)
    for name, end, angle in (("open dead point", top - 2, at_top), ("closed dead point", 2 - bottom, at_bottom)):
        assert q[name].value == pytest.approx(end, rel=1e-10)
        assert q[name].position == pytest.approx(angle, abs=1e-5)
    sideways, farthest = extreme(lambda a: slider(a).real)  # P4, at the upper end of the rod
    assert q["least transmission angle"].value == pytest.approx(acos(farthest / 0.3), rel=1e-9)
    assert q["least transmission angle"].position == pytest.approx(sideways, abs=1e-5)
    assert q["least transmission angle"].of == "P5"


def circles(a: complex, r: float, b: complex, s: float, *, left: bool) -> complex:
    """Return the point at r from a and s from b, to the left of the way from a to b or to the right."""
    d = abs(b - a)
    cosine = (r**2 + d**2 - s**2) / (2 * r * d)
    turn = acos(cosine) * (1 if left else -1)
    return complex(a + r * (b - a) / d * np.exp(1j * turn))


@pytest.mark.parametrize("name", ["toggle_press", "four_bar"])
def test_peaks_are_where_ten_times_as_many_samples_have_them(name: str) -> None:
    scene = scene_files.load(name)
    motion = analytic.solve(scene, scene.drive.law.after(np.linspace(0, 1, 36_001)))
    q = numbers(name)
    for pin in scene.pins:
        x, y = motion[f"{pin.channel}.fx"], motion[f"{pin.channel}.fy"]
        row, peak = int(np.hypot(x, y).argmax()), q[f"largest force at {pin.channel}"]
        assert peak.value == pytest.approx(np.hypot(x, y)[row], rel=1e-7)
        assert cos(peak.position - motion["crank_angle"][row]) == pytest.approx(1, abs=1e-7)
        assert peak.direction == pytest.approx(atan2(y[row], x[row]), abs=1e-3)
        assert (peak.of, peak.channel, peak.unit) == (pin.channel, f"{pin.channel}.fx", "N")


def test_a_guide_that_turns_pushes_across_itself() -> None:
    """A block without mass: its pin and its guide are in balance."""
    q = numbers("quick_return", {"bodies.block.mass": 0})
    pin, guide = q["largest force at A"], q["largest guide force at block"]
    assert guide.value == pytest.approx(pin.value, rel=1e-9)
    assert np.exp(1j * guide.direction) == pytest.approx(-np.exp(1j * pin.direction), abs=1e-9)


def test_work_against_the_forces_that_take_it() -> None:
    jump = 2e-6  # what lines between the samples cut off where a force comes or goes
    assert numbers("crank_press")["work a turn"].value == pytest.approx(1600e3 * 6e-3, rel=5 * jump)
    assert numbers("quick_return")["work a turn"].value == pytest.approx(6e3 * 0.4, rel=5 * jump)
    servo = numbers("servo_press")
    assert servo["work a cycle"].value == pytest.approx(1600e3 * 6e-3, rel=5 * jump)
    small = {"loads": [{"body": "slider", "at": "P5", "force": [0, 5], "last": 6}]}  # at no peak of any force
    assert numbers("toggle_press", small)["work a turn"].value == pytest.approx(5e3 * 6e-3, rel=5 * jump)
    for name in ("toggle_press", "four_bar"):  # a force that does not change, and none
        assert numbers(name)["work a turn"].value == 0


def test_peaks_where_a_force_comes_or_goes() -> None:
    """The press force sets in between two samples, and the torque jumps to its peak there."""
    scene = scene_files.load("crank_press")
    motion = analytic.solve(scene, scene.drive.law.after(np.linspace(0.4, 0.5, 200_001)))
    peak = np.abs(motion["drive.torque"]).max()  # itself off by half a step, 3e-6 rad, times the torque's slope of 3
    assert numbers("crank_press")["peak driving torque"].value == pytest.approx(peak, rel=1e-5)


@settings(max_examples=5, deadline=None)
@given(size=some.floats(0.1, 10), rate=some.floats(0.1, 10))
def test_numbers_go_with_size_and_speed(size: float, rate: float) -> None:
    """No load acts: forces are masses times accelerations."""
    one, other = numbers("four_bar", scaled(1, 1)), numbers("four_bar", scaled(size, rate))
    powers = {"stroke": (1, 0), "peak speed": (1, 1), "peak acceleration": (1, 2), "largest force at B": (1, 2)}
    powers |= {"least transmission angle": (0, 0), "distance to a singular pose": (1, 0)}
    powers |= dict.fromkeys(("peak driving torque", "peak braking torque"), (2, 2))
    for name, (lengths, times) in powers.items():
        assert other[name].value == pytest.approx(one[name].value * size**lengths * rate**times, rel=1e-9)


def scaled(size: float, rate: float) -> Changes:
    """Return the changes that make the four-bar so much larger and faster, and weightless."""
    points = {"A": [0, 0], "B": [250 * size, 0], "T": [500 * size, 0]}
    coupler = {"points": points, "mass": 2.5, "com": [250 * size, 0], "inertia": 52083 * size**2}
    return {
        **{"gravity": None, "drive.speed": -60 * rate, "ground.points.C": [200 * size, 0], "bodies.coupler": coupler},
        **{"bodies.crank.lengths.O-A": 100 * size, "bodies.rocker.lengths.C-B": 250 * size},
        **{"sketch.A": [0, 100 * size], "sketch.B": [200 * size, 250 * size]},
    }


def test_the_shaper_of_the_textbook() -> None:
    """The stroke is 450 mm, and the cut takes twice as long as the return; the other way round it is half."""
    q, backwards = numbers("quick_return"), numbers("quick_return", {"drive.speed": -40})
    assert q["stroke"].value == pytest.approx(0.45, rel=1e-9)
    assert q["quick return"].value == pytest.approx(2.0, rel=1e-6)
    assert backwards["quick return"].value == pytest.approx(0.5, rel=1e-6)


@sampled(3)
@pytest.mark.parametrize(
    ("load", "along", "below"),
    [
        ({}, 1, True),  # without a load, downwards
        ({}, -1, True),
        ({"force": [100, 0]}, 1, True),  # none along the guide
        ({"force": [0, 100]}, -1, True),
        ({"force": [0, -100]}, 1, False),
        ({"force": [0, 100], "last": 6}, -1, True),
        ({"force": [0, -100], "last": 6}, 1, False),
        ({"table": [[-2000, 0], [2000, 1]]}, 1, True),  # along the guide
        ({"table": [[-2000, 0], [2000, 1]]}, -1, False),
    ],
)
def test_the_closed_end_is_against_the_load(load: dict[str, object], along: int, below: bool) -> None:
    loads = [{"body": "slider", "at": "P5", **load}] if load else []
    q = numbers("toggle_press", {"loads": loads, "bodies.slider.slides.along": [0, along]}, MOTION)
    heights = {along * q[f"{end} dead point"].value: end for end in ("closed", "open")}
    assert heights[min(heights) if below else max(heights)] == "closed"
    assert min(heights) == pytest.approx(-1.09, abs=1e-9)


def test_only_what_the_channels_asked_for_give() -> None:
    q = numbers("toggle_press", channels=frozenset(("P5.y", "P3.fx", "P3.fy", "drive.torque")))
    ends = {"stroke", "closed dead point", "open dead point", DWELL}
    drive = {f"peak {way} {of}" for way in ("driving", "braking") for of in ("torque", "power")}
    drive |= {"RMS drive torque", "work a turn"}
    assert set(q) == ends | {"largest force at P3"} | drive
    kinematic = numbers("toggle_press", scene_files.without_masses("toggle_press"))
    assert set(kinematic) == ends | {
        *("quick return", "peak speed", "peak acceleration"),
        *("least transmission angle", "distance to a singular pose"),
    }


def test_a_drive_that_runs_once_has_ends_and_no_return() -> None:
    for end in (-150, -25):
        q = numbers("driven_toggle", {"drive.end": end})
        assert not {"quick return", "closed dead point", "peak driving torque"} & set(q)
        assert q["open end"].value - q["closed end"].value == pytest.approx(q["stroke"].value, rel=1e-12)
        largest = max((q[f"peak {sense} force"] for sense in ("driving", "braking")), key=lambda peak: abs(peak.value))
        assert 1e-3 * end <= largest.position <= 0.1
    single = numbers("offset_slider_crank", {"drive.end": 400})  # a little more than one turn
    assert "quick return" not in single
    assert single["work a cycle"].value != 0


def test_no_quick_return_of_two_strokes() -> None:
    assert "quick return" not in numbers("toggle_press", {"bodies.toggle.lengths.P2-P4": 700})


def test_a_point_has_a_stroke_and_no_ends() -> None:
    scene = scene_files.load("four_bar")
    motion = analytic.solve(scene, scene.drive.law.after(np.linspace(0, 1, 36_001)))
    q = numbers("four_bar")
    assert not {"closed dead point", DWELL, "quick return"} & set(q)
    path = motion["T.x"][::20] + 1j * motion["T.y"][::20]
    longest = max(float(np.abs(path - place).max()) for place in path)  # of 1800 places: off by the square of a step
    assert longest < np.hypot(np.ptp(path.real), np.ptp(path.imag)) * 0.999  # the diagonal of its box
    assert q["stroke"].value == pytest.approx(longest, rel=1e-5)


@sampled(1)
@pytest.mark.parametrize("turn", [0.3, 1.0, 2.2])
def test_the_stroke_of_a_point_is_the_same_in_any_frame(turn: float) -> None:
    scene, own = scene_files.load("four_bar"), numbers("four_bar")["stroke"].value
    reference = uncertified(Change(mirror=1, turn=np.exp(1j * turn), shift=0, length=1.0).scene(scene))
    (stroke,) = (peak.value for peak in peaks(reference, Sampling(72), []) if peak.name == "stroke")
    assert stroke == pytest.approx(own, rel=1e-9)


def test_the_drive_of_a_crank_that_turns_backwards() -> None:
    """Driving and braking are about the power: the torque's own sign is that of its channel."""
    forwards, backwards = (numbers("slider_crank", {"drive.speed": sense * 10 * 30 / pi}) for sense in (1, -1))
    for name in ("peak driving torque", "peak braking torque"):  # the loads are even about the line of the guide
        assert backwards[name].value == pytest.approx(-forwards[name].value, rel=1e-9)
    assert forwards["peak driving torque"].value > 0 > forwards["peak braking torque"].value


def test_a_law_has_its_places_in_its_time() -> None:
    q = numbers("turning_law")
    scene = scene_files.load("turning_law")
    motion = analytic.solve(scene, scene.drive.law.after(np.linspace(0, 1, 11_001)), np.linspace(0, 1.1, 11_001))
    most = int(np.abs(motion["drive.torque"]).argmax())
    drives = motion["drive.torque"][most] * scene.drive.law.at(motion["time"][most]).rate > 0
    power = "peak driving torque" if drives else "peak braking torque"
    for name, channel in (("peak speed", "E.vx"), ("peak acceleration", "E.ax"), (power, "drive.torque")):
        row = int(np.abs(motion[channel]).argmax())
        value = motion[channel][row] if name == power else abs(motion[channel][row])
        assert q[name].value == pytest.approx(value, rel=1e-5)
        assert q[name].position == pytest.approx(motion["time"][row], abs=1e-4)


def test_the_drives_peaks_under_a_law_by_its_formula() -> None:
    """A crank alone, T = I a, at 100 samples a period: power peaks between them, torque where the drive turns round.

    By a hundred times as many samples as the cycle has its power is known to 1e-9, and at the ends of a stroke the
    torque to 1e-4 of its change from sample to sample.
    """
    harmonics = [[0.1, 36, 0.2], [0.03, 35, 0.7], [0.14, 1, 0]]
    law = {"body": "crank", "start": 0, "harmonics": harmonics}
    q = numbers("crank", {"drive": law})
    t = np.linspace(0, 1, 360_001)
    waves = [(size, tau * f, tau * f * t + phase) for size, f, phase in harmonics]
    rate = np.sum([size * w * np.cos(of) for size, w, of in waves], axis=0)
    torque = -4 * 2**2 / 3 * np.sum([size * w**2 * np.sin(of) for size, w, of in waves], axis=0)
    for way, sense in (("driving", 1), ("braking", -1)):
        power = sense * torque * rate
        assert q[f"peak {way} power"].value == pytest.approx(sense * power.max(), rel=1e-7)
        assert abs(q[f"peak {way} torque"].value) == pytest.approx(np.abs(torque)[power > 0].max(), rel=1e-5)
