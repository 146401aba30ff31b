"""What each body was taken to weigh, and by which rule: in the page, in `summary.json` and in a result's table."""

import json

import pytest

import compare
from compare.report.output.files import summary
from compare.report.pages.report import page
from compare.report.plain import json_text
from compare.report.tables import study as tables
from tests import scene_files
from tests.comparisons import Studies

pytestmark = pytest.mark.usefixtures("few_settings")

BAR = {"mass [kg]": 10, "com x [m]": 0.5, "com y [m]": 0.0, "inertia [kg*m^2]": 10 / 12}
RULE = "uniform bar from A to C"


def test_in_summary_json_and_in_the_result_of_check(studies: Studies) -> None:
    (written,) = json.loads(json_text(summary(studies("lever"))))["masses"]
    (row,) = compare.check(scene_files.load("lever"), engines=("analytic",), samples=24).masses.to_dict("records")
    for shown in (written, row):
        assert (shown.pop("body"), shown.pop("taken as")) == ("lever", RULE)
        assert shown == pytest.approx(BAR, rel=1e-15)


def test_in_the_page_in_the_units_of_the_file(studies: Studies) -> None:
    (row,) = tables.masses(studies("lever"))
    assert list(row) == ["body", "mass [kg]", "com x [mm]", "com y [mm]", "inertia [kg*mm^2]", "taken as"]
    assert [row["com x [mm]"], row["inertia [kg*mm^2]"]] == pytest.approx([500, 1e7 / 12], rel=1e-15)
    _, _, after = page(studies("lever")).partition("Mass, centre of mass and inertia of each body</summary>")
    table, _, _ = after.partition("</table>")
    assert '<th scope="row">lever</th>' in table
    assert f'<td class="left">{RULE}</td>' in table or f"<td>{RULE}</td>" in table


def test_a_centre_of_mass_is_in_the_frame_of_its_body() -> None:
    """Of a plate by lengths, and of a bar whose first point is not the origin."""
    press = compare.check("toggle_press", engines=("analytic",), samples=24).masses.set_index("body")
    by = press["taken as"].to_dict()
    assert by["toggle"] == "uniform triangular plate P2, P3, P4"
    assert by["slider"] == "point mass at P5"
    cosine = (490**2 + 760**2 - 490**2) / (2 * 490 * 760)  # at P2, between P3, which is on x, and P4
    assert press.loc["toggle", "com x [m]"] == pytest.approx((0.49 + 0.76 * cosine) / 3, rel=1e-14)
    points = {"B": [250, 40], "A": [0, 40], "C": [1000, 40]}
    moved = scene_files.load("lever", {"bodies.lever.points": points, "sketch.B": [250, 0]})
    (lever,) = compare.check(moved, engines=("analytic",), samples=24).masses.to_dict("records")
    assert [lever["com x [m]"], lever["com y [m]"]] == pytest.approx([0.5, 0.04], rel=1e-15)


def test_a_kinematic_scene_has_none() -> None:
    kinematic = scene_files.load("lever", {"bodies.lever.mass": None})
    assert compare.check(kinematic, engines=("analytic",), samples=24).masses.empty
