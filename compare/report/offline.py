"""Plotly's figure with the buttons of the pages, wherever it is shown: none of them sends its data to another host."""

from typing import Any

from plotly.graph_objects import Figure as Checked

from .figure import CONFIG


class Offline(Checked):  # type: ignore[misc]
    """A figure that a notebook, a browser and a file show by `CONFIG`, unless another configuration is given."""

    def show(self, *where: Any, **options: Any) -> None:
        """Show the figure, as plotly's own does."""
        super().show(*where, **{"config": CONFIG} | options)

    def to_html(self, *how: Any, **options: Any) -> str:
        """Return a page, as plotly's own does."""
        return str(super().to_html(*how, **{"config": CONFIG} | options))

    def write_html(self, *where: Any, **options: Any) -> None:
        """Write a page, as plotly's own does."""
        super().write_html(*where, **{"config": CONFIG} | options)

    def _repr_mimebundle_(self, *parts: Any, **options: Any) -> Any:
        return super()._repr_mimebundle_(*parts, **{"config": CONFIG} | options)

    def _ipython_display_(self) -> None:
        self.show()
