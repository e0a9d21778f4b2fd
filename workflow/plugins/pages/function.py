"""The page of a run or a sweep, for scripts and notebooks."""

from dataclasses import dataclass
from html import escape
from pathlib import Path

from granchain.parts import checked, inputs
from workflow.plugins.pages import need_bokeh

MOST_EMBEDDED = 6_000_000
"""Bytes of a page that is part of a notebook's file when it is displayed; of a larger one there is a link."""


@dataclass(frozen=True)
class Page:
    """HTML page, which a notebook displays: itself, so that it stays when files move, or a link where it is large.

    Attributes:
        path: the file; it needs no network.
    """

    path: Path

    def __repr__(self) -> str:
        return f"<page {self.path}>"

    def _repr_html_(self) -> str:
        if self.path.stat().st_size > MOST_EMBEDDED:
            return f'<p><a href="{self.path.resolve().as_uri()}">{escape(str(self.path))}</a></p>'
        content = escape(self.path.read_text(encoding="utf-8"), quote=True)
        return f'<iframe srcdoc="{content}" width="100%" height="900"></iframe>'


@checked
def view(run_or_sweep: inputs.AnyRun, against: inputs.AnyRun | None = None) -> Page:
    """Write the interactive page of a run or a sweep, ``view.html``, or of two runs, ``against-B.html``.

    Args:
        run_or_sweep: a run, or the directory of a run or a sweep; the page is in its directory.
        against: another run with the same chains and beads, or its directory B.

    Returns:
        The page, which a notebook displays.

    Raises:
        InputError: there are no frames or cases, the two runs cannot be compared, or Bokeh is not installed.

    Examples:
        >>> granchain.view("out")
        <page out/view.html>
    """
    need_bokeh()
    from workflow.plugins.pages import write

    if against is not None:
        return Page(write.write_comparison(inputs.directory_of(run_or_sweep), inputs.directory_of(against)))
    if isinstance(run_or_sweep, str | Path):
        return Page(write.write(Path(run_or_sweep)))
    return Page(write.write(inputs.directory_of(run_or_sweep).path))
