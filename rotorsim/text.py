"""Text from users, made safe for where it is shown: terminal, figures, the viewer's Markdown.

HTML has `html.escape`. Consoles are made without Rich's markup.
"""

from __future__ import annotations

import re

_MARKDOWN = re.compile(r"([\\`*_{}\[\]()<>#+.!|~$-])")


def printable(text: str) -> str:
    r"""Return `text` with what a terminal would obey or cannot show in place of it escaped.

    Examples
    --------
    >>> print(printable("red \x1b[31m, nothing \0"))
    red \x1b[31m, nothing \x00
    """
    return "".join(
        sign if sign.isprintable() else sign.encode("unicode_escape", "surrogatepass").decode()
        for sign in text
    )


def caption(text: str) -> str:
    r"""Return `text` as Matplotlib draws it letter by letter: dollars begin no formula.

    Examples
    --------
    >>> print(caption("$1 and $2"))
    \$1 and \$2
    """
    return text.replace("$", r"\$")


def markdown(text: str) -> str:
    r"""Return `text` as Markdown that shows it letter by letter.

    Examples
    --------
    >>> print(markdown("[A] *b*"))
    \[A\] \*b\*
    """
    return _MARKDOWN.sub(r"\\\1", text)
