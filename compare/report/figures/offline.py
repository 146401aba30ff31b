"""Plotly's own figure, for notebooks and pictures, with the buttons of the pages: none sends its data anywhere."""

from functools import partialmethod

from scenes import InputError

from .figure import Figure, thinned

try:
    from plotly.graph_objects import Figure as PlotlyFigure
except ImportError:
    raise InputError("plot: plotly is not installed: pip install 'linkage-crosscheck[plots]'") from None

TEMPLATE = "plotly_white"
# Every button by name, so that none comes in with another version of plotly; nothing in a figure leads to another host.
BUTTONS = [["toImage"], ["zoom2d", "pan2d"], ["zoomIn2d", "zoomOut2d", "autoScale2d", "resetScale2d"]]
CONFIG = {"modeBarButtons": BUTTONS, "displaylogo": False, "showSendToCloud": False, "plotlyServerURL": ""}


class Offline(PlotlyFigure):  # type: ignore[misc]
    """A figure that a notebook, a browser and a file show by `CONFIG`, unless another configuration is given."""

    show = _ipython_display_ = partialmethod(PlotlyFigure.show, config=CONFIG)
    to_html = partialmethod(PlotlyFigure.to_html, config=CONFIG)
    write_html = partialmethod(PlotlyFigure.write_html, config=CONFIG)
    _repr_mimebundle_ = partialmethod(PlotlyFigure._repr_mimebundle_, config=CONFIG)


def offline(figure: Figure) -> Offline:
    """A figure as plotly's own; a ValueError where an attribute is none of plotly's, or has a value that is not."""
    return Offline({"data": thinned(figure.traces), "layout": figure.layout | {"template": TEMPLATE}})
