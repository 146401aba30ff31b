"""The page with all assemblies of a linkage, each drawn."""

from scenes import Scene
from scenes.model.enclosures import Assemblies

from ..linkage.drawing import Drawing
from ..linkage.svg import by_itself
from ..tables import assemblies as tables
from .html import render


def assemblies_page(scene: Scene, every: Assemblies) -> str:
    """The whole page as HTML; all pictures are at one scale."""
    alone = [Drawing(scene, one.motion) for one in every.found]
    pictures = [by_itself(Drawing(scene, own.motion, alone), 0) for own in alone]
    return render("assemblies.html", scene=scene, every=every, tables=tables, pictures=pictures)
