"""Checks without a reference: each must notice what it is for."""

from dataclasses import replace

import numpy as np
import pytest

import analytic
from compare.engines.runner import run
from compare.judge.checks import checks
from compare.mechanics.mechanics import Mechanics
from compare.mechanics.scales import travels
from scenes import Motion, Sampling
from scenes.scene import GuideForce
from tests import scene_files
from tests.comparisons import References, changed, commanded, of_scene, sampled, violations

NOTICED = [  # a mechanism, a channel, by how much it is moved, the check and body that must notice
    ("toggle_press", "P2.x", 1e-6, "closure", "crank"),
    ("toggle_press", "P3.y", 1e-6, "closure", "rocker"),
    ("toggle_press", "P4.x", 1e-6, "closure", "toggle"),
    ("toggle_press", "P5.x", 1e-6, "closure", "slider"),
    ("toggle_press", "P5.y", 1e-6, "closure", "rod"),
    ("toggle_press", "P3.fx", 1.0, "Newton", "rocker"),
    ("toggle_press", "P4.fy", 1.0, "Newton", "rod"),
    ("toggle_press", "P5.ay", 1e-3, "Newton", "slider"),
    ("toggle_press", "slider.guide_force", 1.0, "Newton", "slider"),
    ("toggle_press", "slider.guide_moment", 1.0, "Euler", "slider"),
    ("toggle_press", "drive.torque", 1.0, "Euler", "crank"),
    ("toggle_press", "toggle.alpha", 1e-1, "Euler", "toggle"),
    ("toggle_press", "rod.alpha", 1e-1, "Euler", "rod"),
    ("toggle_press", "P5.vy", 1e-3, "power", "mechanism"),
    ("toggle_press", "rocker.omega", 1e-1, "power", "mechanism"),
    ("shaper", "rocker.angle", 1e-6, "closure", "block"),  # it carries the slot
    ("shaper", "block.angle", 1e-6, "closure", "block"),
    ("swinging_block", "A.y", 1e-6, "closure", "rod"),
    ("driven_toggle", "K.x", 1e-6, "closure", "plate"),
    ("shaper", "block.guide_force", 1.0, "Newton", "block"),
    ("shaper", "block.guide_force", 1.0, "Newton", "rocker"),
    ("shaper", "block.guide_force", 1.0, "Euler", "rocker"),
    ("shaper", "block.guide_moment", 1.0, "Euler", "rocker"),
    ("shaper", "block.alpha", 1.0, "Euler", "block"),
    ("scotch_yoke", "block.guide_force", 1.0, "Newton", "yoke"),
    ("scotch_yoke", "yoke.guide_moment", 1.0, "Euler", "yoke"),
    ("driven_toggle", "drive.force", 1.0, "Newton", "crosshead"),
    ("driven_toggle", "drive.force", 1.0, "power", "mechanism"),
    ("driven_toggle", "K.vx", 1e-3, "power", "mechanism"),  # where the spring pulls
    ("driven_toggle", "C.x", 1e-6, "Newton", "platen"),  # the table's load
    ("swinging_law", "crank.alpha", 1.0, "power", "mechanism"),
]


@sampled(11)
@pytest.mark.parametrize(("name", "channel", "by", "check", "of"), NOTICED)
def test_a_check_notices(references: References, name: str, channel: str, by: float, check: str, of: str) -> None:
    reference = references(name)
    motion = commanded(reference)
    found = checks(reference.mechanics, changed(motion, channel, by), reference.travel)
    noticed = next(c for c in found if (c.check, c.of) == (check, of))
    assert max(violations(reference, motion).values()) <= 1e-13
    assert noticed.worst > 1e-9
    assert noticed.where == reference.scene.where(float(motion[reference.scene.channels.drive.position][40]))
    assert name != "toggle_press" or noticed.max_at == pytest.approx(200.0)


def test_a_guide_presses_its_slider_and_its_carrier_opposite_ways(references: References) -> None:
    """With the force the other way round neither balances, and both by twice the force."""
    reference = references("shaper")
    motion = commanded(reference)
    turned = Motion({**motion.samples, "block.guide_force": -motion["block.guide_force"]})
    found = violations(reference, turned)
    assert min(found["Newton", body] for body in ("block", "rocker")) > 0.5
    assert found["Newton", "ram"] <= 1e-13


@pytest.mark.parametrize("of", ["stiffness", "length", "table", "gravity"])
def test_another_load_than_the_scenes_is_noticed(references: References, of: str) -> None:
    """A motion solved with a load that is a thousandth off: out of balance, and other forces, but the same motion."""
    reference = references("shaper" if of == "gravity" else "driven_toggle")
    scene = reference.scene
    body = {"stiffness": "plate", "length": "plate", "table": "platen", "gravity": "rocker"}[of]
    if of == "table":
        (load,) = scene.loads
        assert isinstance(load, GuideForce)
        assert load.table is not None
        table = replace(load.table, forces=tuple(1.001 * force for force in load.table.forces))
        wrong = replace(scene, loads=(replace(load, table=table),))
    elif of == "gravity":
        wrong = replace(scene, gravity=(0.0, -9.82))
    else:
        (spring,) = scene.springs
        wrong = replace(scene, springs=(replace(spring, **{of: 1.001 * getattr(spring, of)}),))
    found = violations(reference, commanded(of_scene(reference, wrong)))
    forces = [worst for (check, _), worst in found.items() if check in ("reaction", "torque", "force")]
    assert min(found["Newton", body], found["power", "mechanism"], max(forces)) > 1e-6
    assert max(w for (check, _), w in found.items() if check in ("position", "velocity", "acceleration")) <= 1e-12


@pytest.mark.parametrize("noise", [1e-5, 1.0])
def test_a_body_that_carries_nothing_is_relative_to_the_largest_force(references: References, noise: float) -> None:
    """Noise alone is no violation of 100 % of itself; a force as large as any is one."""
    reference = references("telescope")
    motion = commanded(reference)
    largest = max(float(np.abs(motion[channel]).max()) for channel in ("O.fx", "A.fx"))
    assert np.abs(motion["C.fx"]).max() < 1e-12 * largest
    noisy = changed(motion, "C.fx", noise * largest)
    off = violations(reference, noisy)["Newton", "cylinder"]  # the largest of both axes
    assert off == pytest.approx(noise, rel=0.5)


@sampled(5)
@pytest.mark.parametrize("name", scene_files.MECHANISMS)
@pytest.mark.parametrize("engine", ["analytic", "multiprecision"])
def test_two_models_pass_every_check(references: References, name: str, engine: str) -> None:
    """Two models that share nothing balance by the same signs, at 8 samples a cycle too."""
    scene = references(name).scene
    outcome = run(engine, scene, Sampling(8))
    assert outcome.motion is not None, outcome.reason
    assert max(violations(references(name), outcome.motion).values()) <= 1e-13


def test_checks_with_gravity_and_given_inertia() -> None:
    crank = {"bodies.crank.mass": 3, "bodies.crank.com": [0.4, 0.1], "bodies.crank.inertia": 0.2}
    scene = scene_files.load("slider_crank", crank | {"gravity": [1, -9.81]})
    motion = analytic.solve(scene, np.linspace(0, 6, 100))
    assert max(check.worst for check in checks(Mechanics(scene), motion, travels(scene, motion))) <= 1e-13
