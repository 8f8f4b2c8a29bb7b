"""Shows how far long work is: a bar in a notebook, a line on a terminal, nothing elsewhere."""

from __future__ import annotations

import html
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeAlias

#: Is told a phase of the work in words, and its part that is done, 0 to 1.
Tell: TypeAlias = Callable[[str, float], object]


def _in_notebook() -> bool:
    try:
        from IPython import get_ipython
    except ImportError:
        return False
    shell = get_ipython()
    return shell is not None and hasattr(shell, "kernel")


@contextmanager
def shown(title: str, progress: bool | Tell | None) -> Iterator[Tell | None]:
    """What to tell: the user's own function, or one that shows a bar where there is somebody to see it."""
    if callable(progress):
        yield progress
    elif progress is False:
        yield None
    elif _in_notebook():
        from IPython.display import HTML, display

        def bar(phase: str, part: float) -> object:
            words = html.escape(f"{title}: {phase}")
            return HTML(f'<progress max="1" value="{part:.3f}"></progress> {words}, {part:.0%}')

        handle = display(bar("begins", 0.0), display_id=True)
        yield lambda phase, part: handle.update(bar(phase, part))
        handle.update(HTML(""))
    elif sys.stderr.isatty():

        def line(phase: str, part: float) -> None:
            print(f"\r\x1b[K{title}: {phase}, {part:.0%}", end="", file=sys.stderr, flush=True)

        try:
            yield line
        finally:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)
    else:
        yield None
