"""The exact derivatives of the core against CasADi's: symbols in place of the scene's numbers, differentiated through.

Coordinates, rates, accelerations and multipliers z solve one system R(z, p) = 0, so that dz/dp = -R_z^-1 R_p.
"""

from typing import Any

import numpy as np
import pytest

import analytic
import scenes
from scenes import Sampling
from tests.comparisons import SLOW

casadi = pytest.importorskip("casadi")

from sim_models.casadi.linkage import SymbolicLinkage, channels  # noqa: E402  (its engine is there)
from sim_models.casadi.system import CasadiSystem  # noqa: E402
from sim_models.coordinates.start import begun  # noqa: E402

SAMPLES = 3
TOLERANCE = 1e-11  # of a channel's size and of its derivative's, or of its vector's: both are exact but for roundings
NUMBERS = {
    "toggle_press": (
        *("ground.points.P1.0", "bodies.crank.points.P2.0", "bodies.rocker.lengths.O-P3", "bodies.slider.mass"),
        *("bodies.toggle.lengths.P2-P4", "bodies.slider.slides.through.0", "loads.0.force.1"),
    ),
    "class_iii": ("bodies.plate.lengths.B-C", "bodies.upper.lengths.C-E", "bodies.plate.mass", "gravity.1"),
    "four_bar": ("bodies.coupler.com.0", "bodies.coupler.inertia", "ground.points.C.0", "bodies.coupler.points.T.0"),
}


@pytest.mark.parametrize("name", ["toggle_press", *(pytest.param(n, marks=SLOW) for n in ("class_iii", "four_bar"))])
def test_two_routes_to_the_derivatives_agree(name: str) -> None:
    scene, paths, asked = scenes.load(name), NUMBERS[name], Sampling(SAMPLES)
    exact = analytic.derivatives(scene, paths, asked.commanded(scene), asked.times(scene))
    solved, names = differentiated(scene, paths)
    follower, start, _ = begun(CasadiSystem(scene))
    poses = [*follower.through(start, scene.drive.start, asked.commanded(scene).tolist())]
    for column, driven in enumerate(np.transpose(scene.drive.at(asked.times(scene)))):
        values, slopes = solved(poses[column].x, driven)
        sizes = dict(zip(names, np.abs(slopes).max(axis=1) + np.abs(values), strict=True))
        for slope, channel in zip(slopes, names, strict=True):
            error = np.abs(exact[channel][:, column] - slope).max()
            of_vector = max(size for name, size in sizes.items() if name[:-1] == channel[:-1])
            assert error <= TOLERANCE * max(of_vector, 1e-3), channel


def differentiated(scene: Any, paths: tuple[str, ...]) -> tuple[Any, list[str]]:
    """Return the function of a pose and the drive's position and rates that gives the channels and their slopes."""
    symbols = {path: casadi.SX.sym(path) for path in paths}
    symbolic = scene.with_numbers({path: s * scene.size(scene.numbers[path]) for path, s in symbols.items()})
    linkage = SymbolicLinkage(symbolic, size=SymbolicLinkage(scene).size)
    x, v, a = linkage.x, linkage.v, linkage.a
    held, p, driven = casadi.SX.sym("l", x.shape), casadi.vertcat(*symbols.values()), casadi.SX.sym("driven", 3)
    C_x, unit = casadi.jacobian(linkage.constraints, x), np.eye(x.shape[0])[:, -1] / linkage.drive_unit
    rate = casadi.mtimes(C_x, v)
    R = casadi.vertcat(
        linkage.constraints - unit * driven[0],
        rate - unit * driven[1],
        casadi.mtimes(C_x, a) + casadi.jtimes(rate, x, v) - unit * driven[2],
        casadi.mtimes(C_x.T, held) - linkage.required,
    )
    z, of = casadi.vertcat(x, v, a, held), channels(linkage, held)
    del of[scene.drive_channel]  # it stays as it is
    rows = casadi.vertcat(*of.values())
    parts = [R, casadi.jacobian(R, z), casadi.jacobian(R, p), rows, casadi.jacobian(rows, z), casadi.jacobian(rows, p)]
    evaluated = casadi.Function("parts", [z, p, driven], parts)
    numbers = scenes.numbers_in(scene.name, list(paths))

    def solved(pose: Any, at: Any) -> tuple[Any, Any]:
        guess = np.pad(pose, (0, 3 * len(pose)))
        for _ in range(4):  # rates, accelerations and multipliers follow one from the other
            R, R_z, *_ = (np.array(part) for part in evaluated(guess, numbers, at))
            guess -= np.linalg.solve(R_z, R)[:, 0]
        _, R_z, R_p, values, by_z, by_p = (np.array(part) for part in evaluated(guess, numbers, at))
        return values[:, 0], by_p - by_z @ np.linalg.solve(R_z, R_p)

    return solved, [*of]
