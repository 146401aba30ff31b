"""What is packed in a page: the plots' library and its figures."""

import gzip
import json
import re
from base64 import b64decode


def unpacked(text: str) -> list[str]:
    """Return the library and all figures of a page, as JSON."""
    packed = dict(re.findall(r'<script type="application/gzip" id="(\w+)">([^<]*)</script>', text))
    figures, library = (gzip.decompress(b64decode(packed[name])).decode() for name in ("figures", "plotly"))
    return [library, *(json.dumps(figure, separators=(",", ":")) for figure in json.loads(figures))]


def without_scripts(text: str) -> str:
    """Return a page without its scripts, and what is packed in them."""
    return re.sub(r"<script.*?</script>", "", text, flags=re.DOTALL)
