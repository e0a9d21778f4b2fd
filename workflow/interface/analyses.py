"""Analyses and checks of runs for scripts and notebooks."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from analysis.files.traces import TraceFile
from analysis.tracking.leading_waves import Arrival
from lammps_inputs import InputError, plugins
from lammps_inputs.complaints import suggestion
from workflow.checked import Between, checked
from workflow.inputs import AnyCompared, AnyRun, directory_of
from workflow.runs.run_directory import RunDirectory
from workflow.verdicts import analysis_files
from workflow.verdicts import validate as validating
from workflow.verdicts.analyse import Analysis
from workflow.verdicts.validate import Validation
from workflow.verdicts.validate_against import refuse_offset, run_or_file, validate_against


@checked
def analyze(
    run: AnyRun,
    *,
    figures: bool = False,
    beads: Sequence[Annotated[int, Between(1)]] | None = None,
    arrival: Arrival | None = None,
    gradient: Sequence[str] = (),
    by: Sequence[str] | None = None,
) -> Analysis:
    """Find the waves in a run, and write ``waves.csv`` and ``analysis.json`` beside the frames.

    Args:
        run: a run, or its directory, also one that came back from a cluster.
        figures: whether to draw figures into the directory.
        beads: beads whose velocity over time is drawn; three by default.
        arrival: definition of an arrival: when the bead is fastest ("maximum"), or the centre of the "impulse" until
            then; by default the latter where beads have gaps.
        gradient: quantities whose derivatives are computed with the reference, such as ``["peak_velocity@50"]``.
        by: fields of the scene for these; by default all its numbers.

    Returns:
        The analysis: ``waves`` is the table of ``waves.csv``; ``measurements`` are forces, energy and others;
        ``derivatives`` those that were asked for.

    Raises:
        InputError: there are no frames, they are damaged, or a bead was not recorded; or there is no such derivative.

    Examples:
        >>> analysis = granchain.analyze("out")
        >>> analysis.survey.verdict.sentence[:32]
        'equipartitioned and synchronised'
        >>> analysis = granchain.analyze("steel", gradient=["peak_velocity@10"], by=["kick.velocity"])
        >>> round(analysis.derivatives[0].derivative, 4)  # m/s per m/s of the kick
        0.6821
    """
    chosen, directory = None if beads is None else tuple(beads), directory_of(run)

    def analysis() -> Analysis:
        return analysis_files.analyse(directory, beads=chosen, figures=figures, arrival=arrival)

    if not gradient and by is None:
        return analysis()
    with_derivatives = plugins.needed("gradients", "gradient")
    with_gradient: Analysis = with_derivatives(analysis, directory, gradient, by)
    return with_gradient


@checked
def validate(
    run: AnyRun,
    *,
    against: AnyCompared | None = None,
    units: Literal["scene", "dimensionless"] = "scene",
    tolerances: Mapping[str, Annotated[float, Between(0.0)]] | None = None,
    offset: float | None = None,
) -> Validation:
    """Compare a run with an accurate reference, with another run of its scene, or with a table or traces of your own.

    Args:
        run: what to validate.
        against: another run, or its directory, or a file of yours, also as `trace_file` describes it; the reference
            if omitted.
        units: units of that file: the scene's, or those in which V, T and L are 1.
        tolerances: quantity -> tolerance in V, T and L, in place of the default, such as ``{"velocity": 1e-3}``.
        offset: by how much the times of traces are later than the run's, in the file's units; 0 by default.

    Returns:
        The comparison, also written into the run's directory: ``validation.json``, or ``validation-against.json``.

    Raises:
        InputError: frames or file cannot be used, or the two runs are of different scenes.

    Examples:
        >>> granchain.validate("out")
        <validation of two-chains against reference: passed>
        >>> granchain.validate("out", tolerances={"velocity": 1e-12}).verdict("velocity")
        'EXCEEDED'
    """
    limits = dict(tolerances or {})
    for name in limits:
        if name not in validating.TOLERANCES:
            hint = suggestion(name[:60], validating.TOLERANCES)
            raise InputError(f"tolerances: {name[:60]!r} given{hint}; of {', '.join(validating.TOLERANCES)}")
    directory = directory_of(run)
    if against is None:
        refuse_offset(offset)
        return validating.validate(directory, limits)
    other: RunDirectory | TraceFile | Path
    if isinstance(against, TraceFile):
        other = against
    else:
        other = run_or_file(Path(against)) if isinstance(against, str | Path) else directory_of(against)
    return validate_against(directory, other, dimensionless=units == "dimensionless", tolerances=limits, offset=offset)


@checked
def universe(run: AnyRun) -> Any:
    """Open a run as an ``MDAnalysis.Universe``, also one that was continued; see `analysis.mda.universe`.

    Args:
        run: a run, or its directory.

    Returns:
        The universe: a segment for each chain, a residue for each bead of it. Positions are dimensionless; ``ts.data``
        has float64 values in units of V, T and L, and in the scene's units as ``ts.data["si"]``.

    Raises:
        InputError: there are no frames, or they are damaged.

    Examples:
        >>> granchain.universe("out").segments.segids.tolist()
        ['C1', 'C2']
    """
    from analysis.mda.universe import universe as make_universe

    directory = directory_of(run)
    try:
        return make_universe(directory.problem, directory.dumps)
    except (OSError, ValueError) as error:
        raise InputError(str(error)) from None
