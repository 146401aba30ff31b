"""What the report draws: the right channels, in the units that the axes say, with the errors below."""

from collections.abc import Callable
from dataclasses import replace
from html import unescape
from math import nan
from pathlib import Path
from types import CodeType

import numpy as np
import pandas as pd
import pytest
from jinja2 import Environment, PackageLoader

from compare.mechanics.axis import prefixed
from compare.report.figures.curves import Panel, assur_groups, over_angle, panels
from compare.report.figures.offline import offline
from compare.report.figures.speed import work_precision
from compare.report.pages.html import ByteCode
from compare.report.pages.report import page
from compare.report.tables import study as tables
from compare.study import Study
from scenes import Motion, load
from scenes.model.motion import Samples
from tests import scene_files
from tests.comparisons import SLOW, Studies, sampled, studied
from tests.pages import check_figures


@pytest.fixture(scope="module")
def result() -> Study:
    return studied(load("toggle_press"), ["analytic", "pymunk"])


def panel_of(result: Study, title: str) -> Panel:
    return next(panel for panel in panels(result.reference, result.sampling) if panel.title.startswith(title))


def curve(panel: Panel, name: str) -> Callable[[Motion], Samples]:
    return next(curve.of for curve in panel.curves if curve.name == name)


def test_every_joint_has_a_panel(result: Study) -> None:
    pins = (f"Pin {point}" for point in ("O", "P1", "P2", "P3", "P4"))
    motion = ("P5: displacement", "P5: velocity", "P5: acceleration")
    for wanted in (*motion, *pins, "Guide: force and moment on slider", "Drive: torque on crank"):
        assert panel_of(result, wanted), wanted


def test_curves_are_in_the_units_of_their_axes(result: Study) -> None:
    motion, pin, displacement = result.motion, panel_of(result, "Pin P3"), panel_of(result, "P5: displacement")
    assert ("kN" in pin.axis, "mm" in displacement.axis) == (True, True)
    assert np.allclose(curve(pin, "magnitude")(motion), 1e-3 * np.hypot(motion["P3.fx"], motion["P3.fy"]))
    for x in "xy":
        assert np.allclose(curve(pin, x)(motion), 1e-3 * motion[f"P3.f{x}"])
    assert np.allclose(curve(displacement, "along the guide")(motion), 1e3 * motion["P5.y"])


def test_the_error_below_is_the_engines(result: Study) -> None:
    figure = offline(over_angle(result, panel_of(result, "Pin P3")))
    drawn = next(trace for trace in figure.data if trace.name == "pymunk error")
    motion, true = result.motions["pymunk"], result.motion  # whose drive is where it was asked to be, to rounding
    off = np.hypot(*(motion[f"P3.{axis}"] - true[f"P3.{axis}"] for axis in ("fx", "fy")))
    assert np.allclose(drawn.y, off / result.reference.scale["P3.fx"], rtol=1e-5)
    table = pd.DataFrame(result.channel_errors).set_index(["engine", "channel"])["max"]
    assert max(drawn.y) == pytest.approx(table["pymunk", "P3.fx"], rel=1e-6), "one error figure for one thing"
    assert not any(trace.name == "analytic error" for trace in figure.data), "the reference has no error to itself"
    assert figure.layout.yaxis2.type == "log"
    assert figure.layout.xaxis2.title.text == "crank angle [deg]"


def test_what_gives_one_component_is_drawn_where_that_is_enough(result: Study) -> None:
    """A result of another program often has the slider's way along its guide, and no more of it."""
    reference, pymunk = result.measurements
    assert pymunk.run.motion is not None
    assert pymunk.comparison is not None
    motion = Motion({c: rows for c, rows in pymunk.run.motion.samples.items() if c not in ("P5.x", "P3.fx")})
    actual = {c: rows for c, rows in pymunk.comparison.actual.items() if c not in ("P5.x", "P3.fx")}
    less = replace(pymunk, run=replace(pymunk.run, motion=motion), comparison=replace(pymunk.comparison, actual=actual))
    study = replace(result, measurements=[reference, less])
    along, pin = ([t.name for t in offline(over_angle(study, panel_of(study, p))).data] for p in ("P5: d", "Pin P3"))
    assert along.count("pymunk") == along.count("pymunk error") == 1
    assert (pin.count("analytic"), pin.count("pymunk"), pin.count("pymunk error")) == (3, 1, 1)


@pytest.mark.parametrize(
    ("scale", "factor", "unit"),
    [(0.2, 1e3, "mN"), (1.0, 1.0, "N"), (340e3, 1e-3, "kN"), (1e-15, 1e12, "pN"), (9e6, 1e-3, "kN"), (2e7, 1e-6, "MN")],
)
def test_prefixes(scale: float, factor: float, unit: str) -> None:
    size, named = prefixed(scale, "N")
    assert size == pytest.approx(factor)
    assert named == unit


# --- other drives and joints ------------------------------------------------------------------------------------------


@sampled(1)
@pytest.mark.parametrize(
    ("name", "title", "first", "last", "autorange", "said"),
    [
        (
            "driven_toggle",
            "crosshead displacement [mm]",
            100,
            -150,
            "reversed",
            "−150 mm/s from 100.0 to −150.0 mm, one",
        ),
        ("tangent", "crank angle [deg]", 130, 50, "reversed", "crank at −20 rpm from 130.00 to 50.00°, one cycle"),
        ("turning_law", "time [s]", 0, 1.1, True, "crank by a motion law of 1.1 s, again and again, one cycle"),
        ("shaper", "crank angle [deg]", 10, 370, True, "crank at 60 rpm, one turn, 72 samples per turn"),
    ],
)
def test_curves_run_over_the_drive(
    studies: Studies, name: str, title: str, first: float, last: float, autorange: object, said: str
) -> None:
    result = studies(name)
    for panel in panels(result.reference, result.sampling):
        figure = over_angle(result, panel)
        axis = figure.layout["xaxis2"]
        assert (axis["title"], axis["autorange"]) == ({"text": title}, autorange)
        assert figure.traces[0]["x"][[0, -1]] == pytest.approx([first, last])
    assert said in tables.setup(result)
    unit = title.partition(" [")[2]
    assert f"max_at [{unit}" in next(iter(tables.by_group(result)))
    assert f"max_at [{unit}" in next(iter(tables.checks(result)))
    a_cycle = "ms per turn" if name == "shaper" else "ms per cycle"
    assert work_precision(result).layout["xaxis"]["title"] == {"text": a_cycle}


def test_plotly_takes_every_figure_of_a_report_as_it_is(result: Study) -> None:
    check_figures(page(result))


def test_settings_that_all_failed_are_drawn_without_a_warning(result: Study) -> None:
    failed = [replace(row, status="wrong_branch", solve_min_s=nan) for row in result.speed]
    assert work_precision(replace(result, speed=failed)).layout  # warnings are errors here


def test_a_number_whose_name_leaves_it_open_is_explained_beside_it(result: Study) -> None:
    row = page(result).partition('scope="row">Quick return<')[2].partition("</tr>")[0]
    assert "time to close over time to open" in unescape(row)


def test_a_driven_sliders_effort_is_a_force(studies: Studies) -> None:
    result = studies("driven_toggle")
    panel = panel_of(result, "Drive: force on crosshead")
    assert panel.axis == "force [N]"  # 8 kN
    assert np.allclose(curve(panel, "force")(result.motion), result.motion["drive.force"])


def test_an_output_on_a_slot_and_a_guide_goes_along_the_guide(studies: Studies) -> None:
    """In `tangent`, P is both of the block in the crank's slot and of the slider on the ground."""
    result = studies("tangent")
    along = curve(panel_of(result, "P: displacement"), "along the guide")(result.motion)
    assert np.ptp(along) == pytest.approx(1e3 * result.reference.stroke, rel=1e-12)


def test_assur_groups(studies: Studies) -> None:
    result = studies("driven_toggle")
    figure = assur_groups(result)
    assert figure is not None
    angle, to_lock = (next(t for t in figure.traces if t["name"] == "C" and t["yaxis"] == axis) for axis in ("y", "y2"))
    assert np.allclose(angle["y"], np.degrees(result.motion["C.transmission"]))
    assert np.allclose(to_lock["y"], 1e3 * result.motion["C.to_lock"])
    axis = figure.layout["yaxis2"]
    assert (axis["title"], axis["type"]) == ({"text": "distance [mm]"}, "log")
    assert "from the reference, which alone knows such groups" in page(result)
    without = Motion({channel: result.motion[channel] for channel in result.scene.channels.names()})
    assert assur_groups(replace(result, motion=without)) is None


@sampled(1)
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=SLOW if name == "slotted_class_iii" else ()) for name in scene_files.MECHANISMS]
)
def test_every_mechanism_has_a_page(studies: Studies, name: str) -> None:
    text = page(studies(name))
    assert text.endswith("</html>\n")
    assert "nan" not in str(studies(name).agreement)


def test_templates_are_compiled_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """And anew wherever what is compiled cannot be kept."""
    compiled, real = list[str | None](), Environment._compile

    def compiling(self: Environment, source: str, filename: str) -> CodeType:
        compiled.append(filename)
        return real(self, source, filename)

    monkeypatch.setattr(Environment, "_compile", compiling)
    for folder, times in ((tmp_path, 1), (tmp_path / "missing", 2)):
        compiled.clear()
        for _ in range(2):
            loader = PackageLoader("compare.report.pages", "")
            Environment(loader=loader, bytecode_cache=ByteCode(str(folder))).get_template("base.html")
        assert len(compiled) == times
