"""Build the site: ``python .github/site/build.py [-o DIR] [--pages]``, with ``pip install '.[view,site]'``.

The pages are the Markdown files of the packages, where they stand. They are copied, with the pictures that they show,
to a directory with the same layout, so that their links between each other hold; those with several headings of the
first level become a page for each section, and one with their contents. Beside them stand the notebook, the
reference of the Python interface from its docstrings, the page of a run, and that of ``granchain gallery``, which are
computed. Exit code 1 with a line for each warning of the builder, and for each link that leads nowhere.
"""

import argparse
import html
import html.parser
import importlib.util
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote, urlsplit

import sections

NEEDED = ("latex2mathml", "mkdocstrings", "nbconvert", "nbformat", "zensical")
"""Packages of the extra, imported where they are used: the help is printed without them."""

COMPUTING = ("granchain", "bokeh")
"""Packages with which runs and their pages are made."""

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
PACKAGES = ("lammps_inputs", "analysis", "workflow")

COMMANDS = "workflow/README.md"
"""Page of the commands, which links to those of plug-ins."""

PICTURES = ".github"
"""Folder of the pictures; in the site another name is needed, as names that begin with a dot are left out."""

CODE = re.compile(r"(^```.*?^```|`[^`\n]*`)", re.MULTILINE | re.DOTALL)
EQUATION = re.compile(r"\$\$(.+?)\$\$|\$([^$\n]+(?:\n[^$\n]+)?)\$", re.DOTALL)

LINE_BEGINS = re.compile(r"(?<=[^\n])\n(?=\$[^$])")
"""Ends of lines before an equation: an element of MathML at the beginning of a line would end the paragraph."""


def equations(text: str) -> str:
    """Markdown with its equations, ``$...$`` and ``$$...$$``, as MathML, which browsers typeset without a script."""
    from latex2mathml.converter import convert

    def mathml(match: re.Match[str]) -> str:
        latex, display = (match[1], "block") if match[1] else (match[2], "inline")
        formula = convert(" ".join(latex.replace(r"\|", "|").split()), display=display)
        # `|` would end a cell of a table, `*` and `_` begin emphasis
        return formula.replace("|", "&#x7C;").replace("*", "&#x2A;").replace("_", "&#x5F;")

    pieces = CODE.split(text)
    pieces[::2] = [EQUATION.sub(mathml, LINE_BEGINS.sub(" ", piece)) for piece in pieces[::2]]
    return "".join(pieces)


def unbroken(text: str) -> str:
    """Markdown whose keys and values in tables, code of one word, are marked as words that no line may break."""

    def word(match: re.Match[str]) -> str:
        return f'<code class="word">{html.escape(match[1]).replace("*", "&#x2A;").replace("_", "&#x5F;")}</code>'

    return re.sub(r"^\|.*", lambda row: re.sub(r"`([^`\s|\\]+)`", word, row[0]), text, flags=re.MULTILINE)


def write(path: Path, text: str) -> None:
    """Write a page with its equations typeset and its pictures at their new place."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(unbroken(equations(text.replace(f"{PICTURES}/", "pictures/").replace(".ipynb)", ".md)"))))


def notebook(path: Path, pages: Path) -> None:
    """Write a notebook, with its stored outputs, as a page."""
    import nbformat
    from nbconvert import MarkdownExporter

    body, resources = MarkdownExporter().from_notebook_node(nbformat.read(path, as_version=4))
    target = pages / path.relative_to(ROOT).with_suffix(".md")
    write(target, body)
    for name, content in resources["outputs"].items():
        (target.parent / name).write_bytes(content)


def computed(place: Path, *, pages_only: bool) -> None:
    """Compute what the pages show beside their text: the page of a run and that of the gallery.

    Args:
        place: new directory, where ``two-chains`` and ``gallery`` are written.
        pages_only: write empty pages in their place.
    """
    if pages_only:
        for name in ("two-chains/view.html", "gallery/index.html"):
            (place / name).parent.mkdir(parents=True)
            (place / name).write_text("<!doctype html><title>granchain</title><p>Computed when the site is published.")
        return
    for command in (("run", "two-chains", "-o", "two-chains"), ("view", "two-chains"), ("gallery", "-o", "gallery")):
        subprocess.run([sys.executable, "-m", "workflow", *command], check=True, cwd=place)


def manual() -> dict[str, str]:
    """Text of each page of the manual, by its path in the repository; pages of plug-ins stand in that of commands."""
    tops = (ROOT, *(ROOT / package for package in PACKAGES), ROOT / "workflow" / "tutorials")
    texts = {path.relative_to(ROOT).as_posix(): path.read_text() for top in tops for path in sorted(top.glob("*.md"))}
    plug_ins = {
        path.relative_to(ROOT).as_posix(): path.read_text() for path in ROOT.glob("workflow/plugins/*/README.md")
    }
    texts[COMMANDS] = sections.with_pages(texts[COMMANDS], COMMANDS, plug_ins)
    places = {
        (path, sections.anchor(title)): COMMANDS for path, text in plug_ins.items() for title in sections.titles(text)
    }
    return {path: sections.relinked(text, path, places, anchors=True) for path, text in texts.items()}


def cut_pages() -> dict[str, sections.CutPage]:
    """The pages with several headings of the first level, in sections."""
    stems = {"lammps_inputs/SCENES.md": "scene", COMMANDS: "commands"}
    texts = {path: text for path, text in manual().items() if sections.has_parts(text)}
    return {path: sections.cut(text, stems.get(path, Path(path).stem)) for path, text in texts.items()}


def navigation() -> str:
    """The settings of the builder, with the pages of sections in the navigation."""
    settings = (HERE / "zensical.toml").read_text()
    for path, page in cut_pages().items():
        settings = sections.with_sections(settings, path, page)
    return settings


def assemble(pages: Path, results: Path) -> None:
    """Copy all pages and pictures to a directory, with the layout of the repository.

    Args:
        pages: new directory.
        results: directory of `computed`.
    """
    texts, cut = manual(), cut_pages()
    places = {place: page for path, one in cut.items() for place, page in sections.moved(path, one).items()}
    for path, text in texts.items():
        write(pages / path, sections.relinked(cut[path].overview if path in cut else text, path, places))
    for path, page in cut.items():
        for section in page.sections:
            write((pages / path).with_name(section.name), sections.relinked(section.text, path, places))
    notebook(ROOT / "workflow" / "first-steps.ipynb", pages)
    write(pages / "workflow" / "api.md", (HERE / "api.md").read_text())
    shutil.copy(HERE / "narrow.css", pages)
    shutil.copy(ROOT / "CITATION.cff", pages)
    shutil.copytree(ROOT / PICTURES, pages / "pictures", ignore=shutil.ignore_patterns("site", "workflows"))
    (pages / "workflow" / "two-chains").mkdir()
    shutil.copy(results / "two-chains" / "view.html", pages / "workflow" / "two-chains")
    shutil.copytree(results / "gallery", pages / "gallery", ignore=shutil.ignore_patterns("entries"))


class Links(html.parser.HTMLParser):
    """Collects the links of a page and the names of its places."""

    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.places: set[str] = {""}

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        """Take the links and names of an element."""
        for name, value in attributes:
            if value and (name == "href" or (name == "src" and tag in ("img", "script", "iframe"))):
                self.links.append(value)
            if value and name in ("id", "name"):
                self.places.add(value)


def broken_links(site: Path) -> Iterator[str]:
    """Links of all pages of a site, to files of the site or to places in them, that lead nowhere; one line each."""
    parsed = {}
    for path in site.rglob("*.html"):
        parsed[path] = Links()
        parsed[path].feed(path.read_text())
    for path, page in parsed.items():
        for link in dict.fromkeys(page.links):
            parts = urlsplit(link)
            if parts.scheme or parts.netloc or path.name == "404.html":
                continue
            target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if target.is_dir():
                target /= "index.html"
            places = parsed[target].places if target in parsed else {unquote(parts.fragment)}
            if not target.exists() or unquote(parts.fragment) not in places:
                yield f"{path.relative_to(site)}: {link}"


def main() -> int:
    """Build the site from the arguments of the command line; the exit code."""
    parser = argparse.ArgumentParser(description="Build the site.")
    parser.add_argument("-o", "--output", type=Path, default=ROOT / "build" / "site", help="directory of the site")
    parser.add_argument("--pages", action="store_true", help="pages only, without what takes minutes to compute")
    options = parser.parse_args()
    needed = NEEDED if options.pages else NEEDED + COMPUTING
    if missing := [name for name in needed if importlib.util.find_spec(name) is None]:
        parser.error(f"not installed: {', '.join(missing)}; `pip install '.[view,site]'` in the repository does")
    with tempfile.TemporaryDirectory() as work:
        place = Path(work)
        (place / "results").mkdir()
        computed(place / "results", pages_only=options.pages)
        assemble(place / "pages", place / "results")
        (place / "zensical.toml").write_text(navigation())
        (place / "modules").symlink_to(ROOT)
        command = [sys.executable, "-m", "zensical", "build", "--strict", "-f", place / "zensical.toml"]
        done = subprocess.run(
            command, cwd=place, check=False, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
        )
        sys.stdout.write(done.stdout)
        wrong = [f"{line} leads nowhere" for line in broken_links(place / "site")] if done.returncode == 0 else []
        sys.stderr.writelines(f"{line}\n" for line in wrong)
        if done.returncode or wrong or "griffe:" in done.stdout:  # which warns of docstrings, but not the builder
            return 1
        shutil.rmtree(options.output, ignore_errors=True)
        shutil.copytree(place / "site", options.output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
