"""Plotly's figure with the buttons of the pages, wherever it is shown: none of them sends its data to another host."""

from functools import partialmethod

from plotly.graph_objects import Figure

from .figure import CONFIG


class Offline(Figure):  # type: ignore[misc]
    """A figure that a notebook, a browser and a file show by `CONFIG`, unless another configuration is given."""

    show = _ipython_display_ = partialmethod(Figure.show, config=CONFIG)
    to_html = partialmethod(Figure.to_html, config=CONFIG)
    write_html = partialmethod(Figure.write_html, config=CONFIG)
    _repr_mimebundle_ = partialmethod(Figure._repr_mimebundle_, config=CONFIG)
