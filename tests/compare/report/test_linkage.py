"""The drawing of the linkage: every part where the motion has it, in a picture that holds all poses."""

import re
from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import Element, fromstring, tostring

import numpy as np
import pytest

import scenes
from compare.mechanics.reference import uncertified
from compare.report.linkage.drawing import PX, Drawing
from compare.report.linkage.svg import MAX_FRAMES, by_itself, picture
from scenes import Motion, Scene
from scenes.channels import named
from tests import scene_files
from tests.comparisons import References, commanded, sampled

SVG = "{http://www.w3.org/2000/svg}"
NUMBER = r"-?\d[\d.]*(?:e-?\d+)?"
PLACE = 0.08  # of the picture's units, a thousandth of its longer side each: rounded to one decimal


def numbers(text: str | None) -> list[float]:
    return [float(number) for number in re.findall(NUMBER, text or "")]


def corners(path: Element) -> list[complex]:
    coordinates = numbers(path.get("d"))
    return [complex(*pair) for pair in zip(coordinates[::2], coordinates[1::2], strict=True)]


def drawn(scene: Scene, motion: Motion) -> tuple[Drawing, Element]:
    """The drawing, and its SVG as it was written."""
    drawing = Drawing(scene, motion)
    return drawing, fromstring(tostring(picture(drawing)[0]))


def placed(group: Element, places: list[complex]) -> list[complex]:
    """Places in a group's own frame as they are in the picture."""
    x, y, angle = [*numbers(group.get("transform")), 0.0][:3]
    return [complex(x, y) + np.exp(1j * np.radians(angle)) * place for place in places]


def part(root: Element, body: str) -> Element:
    return next(group for group in root.iter(f"{SVG}g") if group.get("data-turn") == body)


def kind(root: Element, name: str) -> Element:
    return next(element for element in root.iter() if name in (element.get("class") or "").split())


def test_forces_from_nothing_to_very_large_are_drawn_without_a_warning(references: References) -> None:
    motion = commanded(references("four_bar"))
    forces = {c: motion[c] * np.where(np.arange(len(motion[c])), 1e20, 0.0) for c in motion.samples if c[-2:-1] == "f"}
    with np.errstate(all="raise"):
        drawing, _ = drawn(references("four_bar").scene, Motion({**motion.samples, **forces}))
    assert np.isfinite(drawing.box).all()


@sampled(3)
@pytest.mark.parametrize("name", scene_files.MECHANISMS)
def test_every_point_is_in_the_picture_at_every_pose(references: References, name: str) -> None:
    reference = references(name)
    scene, motion = reference.scene, commanded(reference)
    drawing, root = drawn(scene, motion)
    names = {text.text for text in root.iter(f"{SVG}text") if "name" in (text.get("class") or "")}
    assert names == scene.owners.keys()
    *_, width, height = numbers(root.get("viewBox"))
    for point in scene.moving_points:
        places = drawing.units(motion[f"{point}.x"] + 1j * motion[f"{point}.y"])
        assert 0 < places.real.min() <= places.real.max() < width
        assert 0 < places.imag.min() <= places.imag.max() < height
    for body in scene.bodies.values():
        if len(body.points) == 2:
            group = part(root, body.name)
            ends = placed(group, corners([*group.iter(f"{SVG}path")][-1 - (body.slide is not None)]))
            expected = [drawing.units(drawing.places[point])[0] for point in body.points]
            assert np.allclose(ends, expected, rtol=0, atol=0.1), body.name


def test_a_slot_is_drawn_on_its_carrier(references: References) -> None:
    """The block is on the slot, and the slot is turned with the rocker."""
    scene, motion = references("shaper").scene, commanded(references("shaper"))
    drawing, root = drawn(scene, motion)
    rocker = part(root, "rocker")
    inner = next(group for group in rocker.iter(f"{SVG}g") if group is not rocker)
    x, y, angle = numbers(inner.get("transform"))
    slot = numbers(kind(inner, "slot").get("d"))
    start, end = (placed(rocker, [complex(x, y) + np.exp(1j * np.radians(angle)) * at])[0] for at in (slot[0], slot[2]))
    along = (end - start) / abs(end - start)
    block = complex(drawing.units(drawing.places["A"])[0]) - start
    assert abs((along.conjugate() * block).imag) <= 0.1
    assert 0 < (along.conjugate() * block).real < abs(end - start)
    turned = along.conjugate() * np.exp(-1j * motion["rocker.angle"][0])
    assert np.angle(turned) == pytest.approx(np.arctan2(0.1, 2), abs=1e-4)


def test_a_long_name_is_not_cut_off(tmp_path: Path) -> None:
    """Of a point at the left of the picture, and of one at its right."""
    file = tmp_path / "named.toml"
    long = {"O": "Foot_of_the_crank_at_the_left", "C": "Foot_of_the_rocker_at_the_right"}
    file.write_text(re.sub(r"\b[OC]\b", lambda name: long[name[0]], scene_files.text("four_bar")))
    reference = uncertified(scenes.load(file))
    drawing, root = drawn(reference.scene, reference.cycle)
    for name in long.values():
        (group,) = root.iterfind(f".//{SVG}g[@data-point='{name}'][{SVG}text]")
        text = group.find(f"{SVG}text")
        assert text is not None
        left = {"start": 0.0, "middle": -0.5, "end": -1.0}[str(text.get("text-anchor"))]
        wide = 8 * PX * len(name)
        start = numbers(group.get("transform"))[0] + PX * float(str(text.get("x"))) + left * wide
        assert start >= 0
        assert start + wide <= drawing.size[0]


def test_the_sketch_is_where_the_file_has_it(references: References) -> None:
    scene, motion = references("shaper").scene, commanded(references("shaper"))
    drawing, root = drawn(scene, motion)
    ghost = [corner for path in kind(root, "ghost") for corner in corners(path)]
    for point, place in scene.sketch.points.items():
        expected = complex(drawing.units(np.array([complex(*place)]))[0])
        assert min(abs(corner - expected) for corner in ghost) <= 0.1, point


def test_a_load_ends_where_it_attacks_and_a_force_begins_there(references: References) -> None:
    scene, motion = references("scotch_yoke").scene, commanded(references("scotch_yoke"))
    drawing, root = drawn(scene, motion)
    arrows = {
        str(group.findtext(f"{SVG}title")): group
        for group in root.iter(f"{SVG}g")
        if "force" in (group.get("class") or "").split()
    }
    _, shaft, head = pin = next(arrow for name, arrow in arrows.items() if name.startswith("O:"))
    start, tip = placed(pin, [0j, complex(*numbers(head.get("transform"))[:2])])
    assert start == pytest.approx(complex(drawing.units(drawing.places["O"])[0]), abs=PLACE)
    newtons, length = re.findall(r"([\d.]+) N = ([\d.]+) mm", "".join(kind(root, "scale").itertext()))[0]
    force = complex(motion["O.fx"][0], motion["O.fy"][0])
    expected = force / float(newtons) * 1e-3 * float(length) * drawing.per_metre
    assert (tip - start).conjugate() == pytest.approx(expected, abs=0.1)
    assert numbers(shaft.get("transform"))[2] == pytest.approx(abs(expected), rel=1e-3)
    _, shaft, head = next(arrow for name, arrow in arrows.items() if name.startswith("load"))
    assert numbers(head.get("transform"))[:2] == [0, 0]
    assert numbers(next(shaft.iter(f"{SVG}path")).get("d"))[0] == -1


def test_names_stand_clear_of_the_forces(references: References) -> None:
    motion = commanded(references("toggle_press"))
    row = int(np.hypot(motion["P1.fx"], motion["P1.fy"]).argmax())
    drawing, root = drawn(
        references("toggle_press").scene, Motion({c: v[row : row + 1] for c, v in motion.samples.items()})
    )
    shafts = []
    for arrow in drawing.arrows:
        size = drawing.per_metre * drawing.per_newton * complex(arrow.force[0]).conjugate()
        start = complex(drawing.units(drawing.places[arrow.point])[0])
        shafts.append(start + np.linspace(-1 if arrow.load else 0, 0 if arrow.load else 1, 99) * size)
    for group in root.iter(f"{SVG}g"):
        if (name := group.find(f"{SVG}text[@class='sign name']")) is not None:
            side = complex(float(name.get("x", "")), float(name.get("y", "")) - 5)  # px, from the pin to the name
            place = placed(group, [side * PX])[0]
            assert min(abs(shaft - place).min() for shaft in shafts) > 7 * PX, name.text  # half of its height


def test_a_scene_without_masses_has_no_forces() -> None:
    gone = dict.fromkeys([f"bodies.{body}.mass" for body in scene_files.load("shaper").bodies] + ["loads"])
    reference = uncertified(scene_files.load("shaper", gone))
    root = drawn(reference.scene, commanded(reference))[1]
    assert not any(set((element.get("class") or "").split()) & {"force", "scale"} for element in root.iter())


def test_the_picture_is_the_same_at_any_size(references: References) -> None:
    """A millionth as large: as of micrometres."""
    scene, motion = references("shaper").scene, commanded(references("shaper"))
    small = Motion({c: 1e-6 * v if named(c).name in ("x", "y") else v for c, v in motion.samples.items()})
    ground = {point: (1e-6 * x, 1e-6 * y) for point, (x, y) in scene.ground.items()}
    sketch = {point: (1e-6 * x, 1e-6 * y) for point, (x, y) in scene.sketch.points.items()}
    bodies = dict(scene.bodies)
    for name, body in bodies.items():
        if body.slide is not None:
            x, y = body.slide.through
            bodies[name] = replace(body, slide=replace(body.slide, through=(1e-6 * x, 1e-6 * y)))
    tiny = replace(scene, ground=ground, bodies=bodies, sketch=replace(scene.sketch, points=sketch))
    pictures = [drawn(*of)[1] for of in ((scene, motion), (tiny, small))]
    for root in pictures:
        kind(root, "scale").clear()
    one, other = (numbers(tostring(root, "unicode")) for root in pictures)
    assert np.allclose(one, other, rtol=0, atol=0.2)


def test_one_svg_moves_by_itself(references: References) -> None:
    scene, motion = references("shaper").scene, commanded(references("shaper"))
    drawing = Drawing(scene, motion)
    text = by_itself(drawing, MAX_FRAMES)
    assert "<script" not in text
    root = fromstring(text)
    rocker = part(root, "rocker")
    name = str(rocker.get("style")).split()[1]
    frames = re.search(rf"@keyframes {name} {{(.*)}}", str(root[0].text))
    other = Drawing(scene, Motion({c: v[::2] for c, v in motion.samples.items()}))
    assert name not in by_itself(other, MAX_FRAMES), "two on one page"
    assert frames is not None
    steps = re.findall(r"([\d.]+)%{transform:translate\(([^)]*)\) rotate\(([^)]*)deg\)}", frames[1])
    assert len(steps) == 73
    for share, place, angle in steps[::9]:
        row = round(0.72 * float(share))
        assert complex(*numbers(place)) == pytest.approx(complex(drawing.units(drawing.places["C"])[row]), abs=PLACE)
        turned = np.degrees(motion["rocker.angle"][row])
        assert (float(angle) + turned + 180) % 360 - 180 == pytest.approx(0, abs=PLACE)
    still = by_itself(drawing, 0)
    assert "keyframes" not in still
    assert fromstring(still).tag == f"{SVG}svg"
