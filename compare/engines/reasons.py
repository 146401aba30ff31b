"""What engines give as text, whatever it is, as one clean line."""

from scenes.errors import one_line


def text_of(value: object) -> str:
    """Return the text of anything as one clean line, none where that itself fails."""
    try:
        return one_line(str(value))
    except BaseException:  # an engine's own class can do anything here
        return ""


def described(error: BaseException) -> str:
    """Return the name and message of an exception as one clean line."""
    return f"{text_of(type(error).__name__)}: {text_of(error) or 'no message'}"
