"""Every figure of a run as vector graphics, with the numbers behind it."""

from workflow.plugins.export.request import ExportRequest, Writers
from workflow.plugins.export.tables import numbers


def svg(request: ExportRequest) -> Writers:
    """The figures as SVG, whose text is text."""
    return _figures(request, "svg")


def pdf(request: ExportRequest) -> Writers:
    """The figures as PDF."""
    return _figures(request, "pdf")


def _figures(request: ExportRequest, suffix: str) -> Writers:
    from granchain.parts import style  # matplotlib takes half a second to import

    drawn: Writers = {
        f"{name}.{suffix}": lambda path, figure=figure: path.write_bytes(style.picture(figure, suffix))  # type: ignore[misc]
        for name, figure in request.figures.items()
    }
    return {**drawn, **numbers(request)}
