"""The linkage, drawn to scale at a few positions of its drive."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import plotly.graph_objects as go

from scenes import Motion, Scene
from scenes.scene import GROUND, Body

from ..engines.motion_vectors import MotionVectors, Vectors
from ..judge.sketch import at_sketch
from ..study import Study
from .style import BODY_COLOURS, draw, layout, side_by_side

POSES = (0.0, 0.25, 0.5, 0.75)  # of the first cycle
POSES_ONCE = (0.0, 1 / 3, 2 / 3, 1.0)  # of a run that need not end where it began
SLOT_MARGIN = 0.05  # of the travel, at each end


def linkage(study: Study) -> go.Figure:
    """Draw the linkage at a few poses, with the paths of its moving points in grey, and where the sketch shows it."""
    scene, sketched = study.scene, at_sketch(study.reference)
    samples = study.motion.samples
    if sketched is not None:
        samples = {channel: np.append(values, sketched[channel]) for channel, values in samples.items()}
    state = MotionVectors(scene, Motion(samples))
    paths = {point: 1e3 * state.place(point) for point in scene.owners}
    poses = POSES if scene.drive.repeats else POSES_ONCE
    rows = [round(pose * study.sampling.samples) for pose in poses]
    titles = [_title(scene, float(study.motion[scene.drive_channel][row])) for row in rows]
    if sketched is not None:
        rows.append(-1)
        titles.append(f"sketch, {_title(scene, scene.sketch.drive)}")
    figure = side_by_side(titles, 0.01)
    for column, row in enumerate(rows, start=1):
        for point in scene.moving_points:
            path = paths[point][: len(study.motion["time"])]
            draw(figure, "", path.real, path.imag, 1, column, line={"color": "#dddddd", "width": 1})
        _pose(figure, state, paths, row, column)
        figure.update_xaxes(title="x [mm]", matches="x", row=1, col=column)
        figure.update_yaxes(scaleanchor="x", scaleratio=1, row=1, col=column)
    if sketched is not None:
        _ghost(figure, scene, paths, len(rows))
    figure.update_yaxes(title="y [mm]", row=1, col=1)
    return figure.update_layout(layout(_height(np.concatenate(list(paths.values()))), titled=True))


def _height(points: Vectors) -> int:
    """Return the figure's height in pixels: four poses side by side fill a page, and a tall linkage is made smaller."""
    return int(np.clip(140 + 370 * np.ptp(points.imag) / max(np.ptp(points.real), 1e-3), 380, 680))


def _title(scene: Scene, position: float) -> str:
    if scene.driven_slide is not None:
        return f"{scene.drive.body} at {1e3 * position:.4g} mm"
    degrees = np.degrees(position)
    return f"crank at {degrees % 360 if scene.drive.repeats else degrees:.4g}°"


def _pose(figure: go.Figure, state: MotionVectors, paths: Mapping[str, Vectors], row: int, column: int) -> None:
    scene = state.scene

    def add(name: str, points: Vectors, **style: Any) -> None:
        draw(figure, name, points.real, points.imag, 1, column, **style)

    colours = {name: BODY_COLOURS[number % len(BODY_COLOURS)] for number, name in enumerate(scene.bodies)}
    for body in scene.bodies.values():
        if body.slide is not None and body.slide.on != GROUND:
            carrier = body.slide.on
            line = {"color": colours[carrier], "width": 10}
            add("", _slot(state, body, row), group=carrier, line=line, opacity=0.3)
    for body in scene.bodies.values():
        points = _around(body, paths, row)
        closed = len(points) > 2
        outline = np.array([paths[point][row] for point in (*points, *points[:closed])])
        mode = "lines+markers" if len(points) > 1 else "markers"
        marker, line = _marker(state, body, colours[body.name], row), {"color": colours[body.name], "width": 5}
        add(body.name, outline, mode=mode, text=points, line=line, marker=marker, fill="toself" if closed else None)
    for spring in scene.springs:
        ends = np.array([paths[point][row] for _, point in (spring.first, spring.second)])
        add("spring", ends, line={"color": "#777777", "width": 2, "dash": "dot"})
    ground = np.array([1e3 * complex(*place) for place in scene.ground.values()], np.complex128)
    triangle = {"symbol": "triangle-up", "size": 12, "color": "black"}
    add("ground", ground, mode="markers", marker=triangle, text=list(scene.ground))


def _ghost(figure: go.Figure, scene: Scene, paths: Mapping[str, Vectors], column: int) -> None:
    """Draw the bodies where the sketch shows their points, over the pose there, which is the last of the paths."""
    drawn = {point: 1e3 * complex(*place) for point, place in (*scene.ground.items(), *scene.sketch.points.items())}
    for body in scene.bodies.values():
        points = [point for point in _around(body, paths, -1) if point in drawn]
        outline = np.array([drawn[point] for point in (*points, *points[: len(points) > 2])], np.complex128)
        line = {"color": "black", "width": 1, "dash": "dash"}
        draw(figure, "sketch", outline.real, outline.imag, 1, column, text=points, line=line)


def _around(body: Body, paths: Mapping[str, Vectors], row: int) -> tuple[str, ...]:
    """Return the body's points; more than three in the order around their middle, after the first."""
    if len(body.points) <= 3:
        return body.points
    middle = sum(paths[point][row] for point in body.points) / len(body.points)
    first = paths[body.points[0]][row] - middle
    return tuple(sorted(body.points, key=lambda p: float(np.angle((paths[p][row] - middle) / first) % (2 * np.pi))))


def _marker(state: MotionVectors, body: Body, colour: str, row: int) -> dict[str, Any]:
    """Return the pins' marks; a slider's first point is a block on its guide."""
    if body.slide is None:
        return {"size": 7, "color": "white", "line": {"color": colour, "width": 2}}
    others = len(body.points) - 1
    marker = {
        "size": [22 if body.slide.on == GROUND else 14, *[7] * others],
        "color": [colour, *["white"] * others],
        "symbol": ["square", *["circle"] * others],
    }
    if body.slide.on != GROUND:
        along = state.frame(body.slide.on)[1][row] * complex(*body.slide.along)
        marker["angle"] = -np.degrees(np.angle(along))  # clockwise
    return marker | ({"line": {"color": colour, "width": 2}} if others else {})


def _slot(state: MotionVectors, body: Body, row: int) -> Vectors:
    """Return both ends of the way that a slider takes on its carrier, where that is at one pose, shape (2,), mm."""
    assert body.slide is not None
    origin, x_axis = (vectors[row] for vectors in state.frame(body.slide.on))
    way = state.on_guide(body).real
    carrier = state.scene.bodies[body.slide.on]
    if len(carrier.points) == 1:  # nothing else would show where the slot belongs
        pin = x_axis.conjugate() * (state.place(carrier.points[0])[row] - origin) - complex(*body.slide.through)
        way = np.append(way, (pin * complex(*body.slide.along).conjugate()).real)
    margin = SLOT_MARGIN * np.ptp(way)
    ends = np.array([way.min() - margin, way.max() + margin])
    slot: Vectors = 1e3 * (origin + x_axis * (complex(*body.slide.through) + ends * complex(*body.slide.along)))
    return slot
