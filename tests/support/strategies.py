"""Hypothesis strategies: any scene that is accepted, and any text that somebody may type as one."""

import math

from hypothesis import strategies as st

from lammps_inputs import Kick, Material, Output, Scene
from lammps_inputs.ingredients.coupling import Coupling
from lammps_inputs.limits.closing import never_closes
from lammps_inputs.limits.solids import impossible

NAMES = st.from_regex(r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}", fullmatch=True)


MATERIALS = st.builds(
    Material,
    radius=st.floats(1e-6, 1.0),
    density=st.floats(10.0, 3e4),
    youngs_modulus=st.floats(1e5, 1e12),
    poisson_ratio=st.floats(-0.9, 0.5),
).filter(lambda ball: not impossible(ball.radius, ball.density, ball.youngs_modulus))


CHAINS = st.integers(1, 6)


@st.composite
def scenes(draw: st.DrawFn, *, chains: st.SearchStrategy[int] = CHAINS, ends: bool = True) -> Scene:
    """Scenes that are accepted, from small to far out; with ``ends=False`` always with a duration."""
    count = draw(chains)
    beads = draw(st.integers(2, 40))
    places = st.tuples(st.integers(1, count), st.integers(1, beads))
    material = draw(st.none() | MATERIALS)
    speed = draw(st.floats(1e-12, 1e12))
    if material is not None:  # slower than sound, and too slow for overlaps of a radius
        speed = draw(st.floats(1e-12, 0.1)) * math.sqrt(material.youngs_modulus / material.density)
    signs = st.sampled_from([-1.0, -0.37, 0.1, 1.0])
    kicks = tuple(
        Kick(chain=chain, bead=bead, velocity=speed * draw(signs))
        for chain, bead in draw(st.lists(places, min_size=1, max_size=4, unique=True))
    )
    unit = Scene(name="unit", chains=count, beads=beads, kick=kicks, material=material, until_bead=1).scale
    coupling = draw(st.none() | st.floats(0.0, 1e6).map(lambda kappa: Coupling(stiffness=kappa * unit.stiffness)))
    every = draw(st.none() | st.floats(1e-3, 1e1).map(lambda time: time * unit.time))
    timestep = None if every is None else draw(st.none() | st.integers(1, 10**6).map(lambda steps: every / steps))
    recorded = draw(st.just("all") | st.lists(st.integers(1, beads), min_size=1, unique=True).map(tuple))
    duration: float | None = draw(st.floats(1e-3, 1e3)) * unit.time
    gap = draw(st.just(0.0) | st.floats(0.0, 1e3)) * unit.length
    kappa = 0.0 if coupling is None else coupling.stiffness / unit.stiffness
    moved = [(kick.chain, kick.bead, kick.velocity / unit.velocity) for kick in kicks]
    if never_closes(count, kappa, gap / unit.length, moved, beads):
        gap = 0.0
    until_bead = None
    if ends and draw(st.booleans()):
        duration, until_bead = None, draw(st.integers(1, beads))
    return Scene(
        name=draw(NAMES),
        description=draw(st.text(st.characters(exclude_categories=["Cc", "Cs", "Zl", "Zp"]), max_size=200)),
        chains=count,
        beads=beads,
        gap=gap,
        coupling=coupling,
        kick=kicks,
        material=material,
        duration=duration,
        until_bead=until_bead,
        timestep=timestep,
        scheme=draw(st.none() | st.sampled_from(["verlet", "suzuki4"])) if timestep is None else None,
        output=Output(every=every, beads=recorded),
    )


_KEYS = [*Scene.model_fields, "velocity", "stiffness", "every"]

_MARKS = ": |, |- |? |[|]|{|}|\n|\n  |\t|#|&a |*a|<<: |---\n|...\n|%YAML 1.1\n|'|\"|\\|>\n|~|=|!|\0|\ufeff|\x85|\u2028"
_TAGS = "!!int |!!float |!!bool |!!null |!!str |!!map |!!seq |!!set |!!omap |!!pairs |!!binary |!!timestamp "
_WORDS = '1|-1|0|1.0|1e5|-|.inf|.nan|1e999|true|yes|null|0x1|1:30|all|linear|\'\\ud800\'|"\\ud800"|"\\UFFFFFFFF"'
_PIECES = [*_KEYS, *(f"{key}: " for key in _KEYS), *_MARKS.split("|"), *_TAGS.split("|"), *_WORDS.split("|")]

YAML_LIKE = st.lists(st.sampled_from(_PIECES), max_size=30).map("".join)
"""Text made of what YAML gives a meaning to."""

VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text() | st.sampled_from([math.inf, 10**400]),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=9), inner, max_size=3),
    max_leaves=6,
)
"""Any value that YAML can hold."""
