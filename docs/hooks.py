"""What mkdocs does beyond its plug-ins: pages and pictures from outside docs/, and formulas without a script."""

import re
from html import unescape
from pathlib import Path

from latex2mathml.converter import convert
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[1]
OUTSIDE = {"index.md": "README.md"} | {name: name for name in ("CONTRIBUTING.md", "CHANGELOG.md")}
DISPLAY = {"span": "inline", "div": "block"}
FORMULA = re.compile(r'<(span|div) class="arithmatex">\\[(\[](.*?)\\[)\]]</\1>', re.DOTALL)


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the first page and what else lies outside docs/, with links between them as they are on the site."""
    for name, path in OUTSIDE.items():
        if (ROOT / path).exists():
            files.append(File.generated(config, name, content=_links((ROOT / path).read_text("utf-8"))))
    for file in (ROOT / "results" / "published").iterdir():
        files.append(File.generated(config, f"published/{file.name}", abs_src_path=str(file)))
    return files


def on_page_markdown(markdown: str, **_: object) -> str:
    """Return a page with the links that hold on the site."""
    return _links(markdown)


def on_page_content(html: str, **_: object) -> str:
    """Return a page with its formulas as MathML, which browsers show themselves; a wide one scrolls by itself."""

    def shown(found: re.Match[str]) -> str:
        formula: str = convert(unescape(found[2]), display=DISPLAY[found[1]])
        return f'<div style="overflow-x: auto" tabindex="0">{formula}</div>' if found[1] == "div" else formula

    return FORMULA.sub(shown, html)


def _links(markdown: str) -> str:
    """Return Markdown whose links to files outside docs/, or from there into it, are those of the site."""
    markdown = re.sub(r"\]\((\.\./)?results/published/", "](published/", markdown)
    return re.sub(r"\]\((\.\./|docs/)(?=\w+\.md)", "](", markdown).replace("](README.md", "](index.md")
