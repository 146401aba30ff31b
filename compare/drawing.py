"""The linkage, drawn to scale at a few crank angles."""

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from scenes import Motion, Scene
from scenes.motion import Samples

from .figures import LAYOUT, SUBTITLED
from .study import Study

POSES = (0.0, 0.25, 0.5, 0.75)  # of the first turn
BODY_COLOURS = ("#e69f00", "#56b4e9", "#009e73", "#cc79a7", "#0072b2", "#d55e00", "#f0e442")  # Okabe and Ito


def linkage(study: Study) -> go.Figure:
    """Draw the linkage at `POSES`, with the paths of its moving points in grey."""
    scene, motion = study.scene, study.motion
    rows = [round(pose * study.sampling.samples) for pose in POSES]
    titles = [f"crank at {np.degrees(motion['crank_angle'][row]) % 360:.4g}°" for row in rows]
    figure = make_subplots(1, len(POSES), subplot_titles=titles, shared_yaxes=True, horizontal_spacing=0.01)
    for column, row in enumerate(rows, start=1):
        _pose(figure, scene, motion, row, column)
        figure.update_xaxes(title="x [mm]", matches="x", row=1, col=column)
        figure.update_yaxes(scaleanchor="x", scaleratio=1, row=1, col=column)
    figure.update_yaxes(title="y [mm]", row=1, col=1)
    return figure.update_layout(LAYOUT | SUBTITLED, height=680)


def _pose(figure: go.Figure, scene: Scene, motion: Motion, row: int, column: int) -> None:
    shown = {"row": 1, "col": column}
    legend = column == 1
    for point in scene.moving_points:
        path_x, path_y = _path(scene, motion, point)
        line = {"color": "#dddddd", "width": 1}
        figure.add_scatter(x=path_x, y=path_y, mode="lines", line=line, hoverinfo="skip", showlegend=False, **shown)
    for number, body in enumerate(scene.bodies.values()):
        colour = BODY_COLOURS[number % len(BODY_COLOURS)]
        paths = [_path(scene, motion, point) for point in body.points]
        x, y = [path[0][row] for path in paths], [path[1][row] for path in paths]
        closed = len(body.points) > 2
        marker = {"size": 7, "color": "white", "line": {"color": colour, "width": 2}}
        if body.slide is not None:
            marker = {"size": 22, "color": colour, "symbol": "square"}
        figure.add_scatter(
            x=[*x, x[0]] if closed else x,
            y=[*y, y[0]] if closed else y,
            fill="toself" if closed else None,
            mode="markers" if body.slide is not None else "lines+markers",
            line={"color": colour, "width": 5},
            marker=marker,
            text=body.points,
            name=body.name,
            legendgroup=body.name,
            showlegend=legend,
            **shown,
        )
    ground = np.array(list(scene.ground.values())) * 1e3
    marker = {"symbol": "triangle-up", "size": 12, "color": "black"}
    names = list(scene.ground)
    figure.add_scatter(
        x=ground[:, 0], y=ground[:, 1], mode="markers", marker=marker, text=names, name="ground", showlegend=legend,
        legendgroup="ground", **shown,
    )  # fmt: skip


def _path(scene: Scene, motion: Motion, point: str) -> tuple[Samples, Samples]:
    """Return the point's path, mm."""
    if point in scene.ground:
        x, y = scene.ground[point]
        return np.full_like(motion["time"], 1e3 * x), np.full_like(motion["time"], 1e3 * y)
    return 1e3 * motion[f"{point}.x"], 1e3 * motion[f"{point}.y"]
