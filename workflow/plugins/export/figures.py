"""Every figure of a run as vector graphics, with the numbers behind it."""

from workflow.plugins.export.request import Writers
from workflow.plugins.export.results import Results
from workflow.plugins.export.tables import numbers


def svg(results: Results) -> Writers:
    """The figures as SVG, whose text is text."""
    return _figures(results, "svg")


def pdf(results: Results) -> Writers:
    """The figures as PDF."""
    return _figures(results, "pdf")


def _figures(results: Results, suffix: str) -> Writers:
    from granchain.parts import drawing, style  # matplotlib takes half a second to import

    drawn: Writers = {
        f"{name}.{suffix}": lambda path, sheet=sheet: path.write_bytes(style.picture(drawing.draw(sheet), suffix))  # type: ignore[misc]
        for name, sheet in results.figures.items()
    }
    return {**drawn, **numbers(results)}
