"""The table of channels, against what the reference page and `scenes/channels.py` promise, written out by hand."""

import pytest

from scenes import Scene
from scenes.channels import Channel, Role
from scenes.scene import GROUND
from tests import scene_files
from tests.naming import loaded
from tests.scene_files import Changes

UNITS = {  # by the end of a name: one unit a quantity, and the role
    "time": ("s", Role.time),
    "crank_angle": ("rad", Role.input),
    "displacement": ("m", Role.input),
    **dict.fromkeys(("x", "y"), ("m", Role.kinematic)),
    **dict.fromkeys(("vx", "vy"), ("m/s", Role.kinematic)),
    **dict.fromkeys(("ax", "ay"), ("m/s^2", Role.kinematic)),
    "angle": ("rad", Role.kinematic),
    "omega": ("rad/s", Role.kinematic),
    "alpha": ("rad/s^2", Role.kinematic),
    **dict.fromkeys(("fx", "fy", "guide_force"), ("N", Role.force)),
    **dict.fromkeys(("guide_moment", "torque"), ("N*m", Role.force)),
    "friction_moment": ("N*m", Role.friction),
    "friction_force": ("N", Role.friction),
    "power": ("W", Role.friction),
    "speed": ("m/s", Role.magnitude),
    "acceleration": ("m/s^2", Role.magnitude),
    **dict.fromkeys(("guide_fx", "guide_fy"), ("N", Role.given)),
    "transmission": ("rad", Role.own),
    "to_lock": ("m", Role.own),
}
ASKED = (Role.time, Role.input, Role.kinematic, Role.force, Role.friction)
SCENES = (
    *scene_files.MECHANISMS,
    *("wedge", "two_blocks", "cross_slide", "shared_pin", "three_at_a_pin", "gas_spring", "parallelogram"),
    *("toggle_press", "toggle_press_friction", "sticking_drawer", "crank_press_friction"),
)
# A crank of 1 m that drives a slider by a rod; masses, a guide with friction, and a pin with friction.
FULL: Changes = {
    **{f"bodies.{body}.mass": 1 for body in ("crank", "rod", "slider")},
    "friction": [
        {"at": "B", "coefficient": 0.1, "radius": 0.01},
        {"slider": "slider", "coefficient": 0.1, "length": 0.2},
    ],
}
A_DRIVEN_SLIDER: Changes = {
    **{f"bodies.{body}.mass": 1 for body in ("crank", "rod", "slider")},
    "drive": {"body": "slider", "speed": -0.1, "start": 2.9, "end": 2.5},
    "sketch": {"displacement": 2.8, "A": [1, 0.3], "B": [2.8, 0]},
}


def rows(scene: Scene) -> list[Channel]:
    return [scene.channels[name] for name in scene.channels.names(*Role)]


def called(scene: Scene, points: Changes, bodies: Changes) -> Scene:
    """The scene with some of its points and bodies under other names."""
    every = {point: points.get(point, point) for point in scene.owners}
    return loaded(scene.tables, every, {body: bodies.get(body, body) for body in scene.bodies})


def test_of_a_slider_crank_every_row() -> None:
    """In the order of the files: what it is of, its group of errors, and for which others it stands."""
    found = [(row.name, row.kind, row.subject, row.group) for row in rows(scene_files.load("slider_crank", FULL))]
    points = [
        (f"{point}.{letter}{axis}", "point", point, group)
        for point in "AB"
        for letter, group in (("", "position"), ("v", "velocity"), ("a", "acceleration"))
        for axis in "xy"
    ]
    turns = [
        (f"{body}.{quantity}", "body", body, group)
        for body in ("crank", "rod")
        for quantity, group in (("angle", "position"), ("omega", "velocity"), ("alpha", "acceleration"))
    ]
    pins = [(f"{pin}.f{axis}", "pin", pin, "reaction") for pin in "OAB" for axis in "xy"]
    assert found == [
        ("time", "time", "", ""),
        ("crank_angle", "drive", "crank", "drive"),
        *points,
        *turns,
        *pins,
        ("slider.guide_force", "guide", "slider", "reaction"),
        ("slider.guide_moment", "guide", "slider", "reaction"),
        ("drive.torque", "drive", "crank", "torque"),
        ("B.friction_moment", "pin", "B", "reaction"),
        ("slider.friction_force", "guide", "slider", "reaction"),
        ("friction.power", "friction", "", "reaction"),
        ("slider.guide_fx", "guide", "slider", "reaction"),
        ("slider.guide_fy", "guide", "slider", "reaction"),
        *((f"{point}.speed", "point", point, "velocity") for point in "AB"),
        *((f"{point}.acceleration", "point", point, "acceleration") for point in "AB"),
        *((f"{pin}.force", "pin", pin, "reaction") for pin in "OAB"),
    ]


@pytest.mark.parametrize("name", SCENES)
def test_names_are_unique_and_of_each_joint_there_are_all(name: str) -> None:
    """Rows that had one name would be one: counted by joint, body and point, none is missing."""
    scene = scene_files.load(name)
    moving = [point for point, owners in scene.owners.items() if GROUND not in owners]
    pins = sum(len(owners) - 1 for owners in scene.owners.values())
    slides = sum(body.slide is not None for body in scene.bodies.values())
    kinematic = 6 * len(moving) + 3 * len(scene.turning)
    forces = 2 * (pins + slides) + 1 if scene.has_masses else 0  # a multiplier of each constraint, and of the drive's
    friction = len(scene.friction) + bool(scene.friction)  # its power too
    magnitudes = 2 * len(moving) + (pins if scene.has_masses else 0)
    table = scene.channels
    assert len(table.names(Role.kinematic)) == kinematic
    assert len(table.names(Role.force)) == forces
    assert len(table.names(Role.friction)) == friction
    assert len(table.names(Role.magnitude)) == len(table.magnitudes) == magnitudes
    assert len(table.names()) == len({*table.names()}) == 2 + kinematic + forces + friction
    assert table.names() == table.names(*ASKED)  # and no magnitude, no axis of a guide, nothing of the core's


@pytest.mark.parametrize("name", SCENES)
def test_a_quantity_has_one_unit_and_one_role(name: str) -> None:
    scene = scene_files.load(name)
    by_hand = {**UNITS, "force": ("N", Role.magnitude)}
    for row in rows(scene):
        unit, role = ("N", Role.force) if row.name == "drive.force" and row.kind == "drive" else by_hand[row.quantity]
        assert (row.unit, row.role) == (unit, role), row.name
        assert row.name.rpartition(".")[2] == row.quantity
        assert row.header == f"{row.name} [{unit}]"
        assert row.modulo_turn == (row.quantity == "angle")  # the drive's goes on over turns
        assert row.name in scene.channels
        assert scene.channels.find(row.kind, row.subject, row.quantity) is not None


def test_a_rate_s_integral_is_the_channel_below() -> None:
    table = scene_files.load("slider_crank", FULL).channels
    below = {"A.ay": "A.vy", "A.vy": "A.y", "A.y": None, "rod.alpha": "rod.omega", "rod.omega": "rod.angle"}
    below |= {"rod.angle": None, "A.fx": None, "drive.torque": None}
    assert {name: table.below(name) for name in below} == below


def test_what_the_core_alone_has_is_in_no_file() -> None:
    table = scene_files.load("slider_crank", FULL).channels
    for name in ("transmission", "B.transmission", "B.to_lock", "rod/slider.to_lock", "slider.to_lock"):
        row = table[name]
        assert (row.unit, row.role) == UNITS[row.quantity]
        assert name in table
        assert name not in table.names(*ASKED)
    for name in ("C.x", "drive.force", "crank.force", "rod.guide_force", "O.x", "C.to_lock", "rod/C.to_lock", ""):
        assert name not in table
        with pytest.raises(KeyError):
            table[name]


def test_a_pin_called_drive_keeps_its_channels_beside_those_of_the_drive() -> None:
    """The size of the pin's force would have the name of the drive's, and has the later body in its name too."""
    scene = called(scene_files.load("slider_crank", A_DRIVEN_SLIDER), {"B": "drive"}, {})
    table = scene.channels
    effort, pin = table["drive.force"], table["drive/slider.force"]
    assert (effort.kind, effort.subject, effort.role) == ("drive", "slider", Role.force)
    assert (pin.kind, pin.subject, pin.role) == ("pin", "drive", Role.magnitude)
    assert pin.components == ("drive.fx", "drive.fy")
    assert table.forces_of_pins == {"O": "O.force", "A": "A.force", "drive": "drive/slider.force"}
    assert (table["drive.displacement"].kind, table["drive.x"].kind) == ("drive", "point")
    plain = scene_files.load("slider_crank", A_DRIVEN_SLIDER).channels
    assert len(table.names(*Role)) == len(plain.names(*Role))
    assert "B/slider.force" not in plain


def test_no_body_is_called_drive_whose_channels_would_be_those_of_the_drive() -> None:
    """A guide of it would have `drive.force` beside the drive's."""
    line = scene_files.refused(lambda: called(scene_files.load("slider_crank", FULL), {}, {"slider": "drive"}))
    assert line == "named.toml: bodies.drive: the name 'drive' is taken; choose another"


@pytest.mark.parametrize("body", ["crank", "slider"])
@pytest.mark.parametrize("name", ["friction", "time", "crank_angle", "transmission", "A"])
def test_a_body_called_as_a_channel_or_a_point_is_found_as_the_body(body: str, name: str) -> None:
    """The table is the one under plain names, with the body's in the place of its own."""
    scene = scene_files.load("slider_crank", FULL)
    plain, table = scene.channels, called(scene, {}, {body: name}).channels
    assert [*table.names(*Role)] == [
        row.name.replace(f"{body}.", f"{name}.") if row.subject == body and row.kind != "drive" else row.name
        for row in rows(scene)
    ]
    for row in rows(scene):
        subject = name if row.subject == body else row.subject
        found = table.find(row.kind, subject, row.quantity)
        assert found is not None
        assert (found.unit, found.role, found.group) == (row.unit, row.role, row.group)
    assert plain.find("body", name, "angle") is None
