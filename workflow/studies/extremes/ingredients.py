"""Cells of what chains may be made of: loads, losses, masses, exponents and drives, each from next to none to too much.

Those that need many steps are short: what goes wrong there does so at once.
"""

from workflow.studies.extremes.cells import BASE, Cell, Plain, changed, decades, scaled


def loads() -> list[Cell]:
    """Static loads, in units of the forces of the kick."""
    return [
        *(_load(f) for f in (*decades(-9, 3, 3), 1e6, 1e7)),
        *(_gravity(g) for g in (1e-9, 1e-3, 1.0, 1e3)),
        *(_loaded_exponent(p) for p in (1.0, 3.0)),
        *(_column_of_exponent(p) for p in (1.0, 3.0)),
    ]


def losses() -> list[Cell]:
    """Dashpots of every law, from none to where beads stick."""
    return [
        *(_lossy("dashpots", g, contact=g) for g in (0.0, 1e-9, 0.1, 1.0, 10.0, 1e3, 1e4)),
        *(_lossy("dashpots, cut", g, contact=g, tension="cut") for g in (0.1, 10.0, 1e3)),
        *(_lossy("viscoelastic", b, contact=b, law="viscoelastic") for b in (1e-3, 1.0, 1e3)),
        *(_lossy("restitution", e, contact=e, law="restitution") for e in (1e-30, 0.5, 0.999999, 1.0)),
        *(_lossy("drag", c, beads=c) for c in (1e-9, 0.1, 1.0, 10.0, 1e3, 1e4)),
        *(_lossy("drag, rows", c, coupling=c) for c in (0.1, 10.0, 1e3)),
        *_lossy_corners(),
    ]


def masses() -> list[Cell]:
    """Light beads and heavy ones."""
    tapers = {"1e-9": 1e-9, "to 0.001": 0.0764, "to 1e-9": 0.3}
    return [
        *(_two_by_two(m) for m in (1e-3, 1e-2, 0.1, 10.0, 1e3, 1e7)),
        *(_impurity(m) for m in (1e-3, 1e3)),
        *(Cell("taper", name, changed(BASE, taper=share, duration=20.0)) for name, share in tapers.items()),
    ]


def exponents() -> list[Cell]:
    """Contacts from springs to walls."""
    return [_exponent(p) for p in (1.0, 1.05, 1.25, 2.0, 3.0)]


def drives() -> list[Cell]:
    """From slower than the chain to faster than anything in it."""
    return [
        *(_moved(f) for f in (1e-3, 0.1, 1.0, 1e3)),
        *(_forced(f) for f in (0.1, 1e3)),
    ]


def _load(force: float) -> Cell:
    """Pressed together by a force; at large ones sound is fast and runs are short."""
    duration = 30.0 if force <= 1.0 else 10.0
    return Cell("load", f"{force:g}", changed(BASE, precompression={"force": force}, duration=duration))


def _gravity(acceleration: float) -> Cell:
    """A column on a plate."""
    held: Plain = {"gravity": acceleration, "walls": {"right": "flat"}}
    return Cell("gravity", f"{acceleration:g}", changed(BASE, **held, duration=10.0))


def _loaded_exponent(exponent: float) -> Cell:
    parts: Plain = {"precompression": {"force": 1.0}, "contact": {"exponent": exponent}}
    return Cell("load, exponent", f"{exponent:g}", changed(BASE, **parts, duration=10.0))


def _column_of_exponent(exponent: float) -> Cell:
    parts: Plain = {"gravity": 1.0, "walls": {"right": "bead"}, "contact": {"exponent": exponent}}
    return Cell("gravity, exponent", f"{exponent:g}", changed(BASE, **parts, duration=10.0))


def _lossy(axis: str, coefficient: float, **damping: float | str) -> Cell:
    duration = 10.0 if coefficient <= 10.0 else 1.0
    return Cell(axis, f"{coefficient:g}", changed(BASE, damping=damping, duration=duration))


def _lossy_corners() -> list[Cell]:
    def corner(value: str, *, like: Plain = BASE, ranks: int = 1, **changes: object) -> Cell:
        return Cell("losses, corners", value, changed(like, **{"duration": 10.0, **changes}), ranks=ranks)

    dashpots: Plain = {"contact": 0.1}
    return [
        corner("dashpots, V 1e-12", like=scaled(BASE, 1e-12), damping={"contact": 1e-4}, duration=3e3),
        corner("dashpots, gap", damping=dashpots, gap=1.0),
        corner("dashpots, accuracy 1e-4", damping=dashpots, accuracy=1e-4),
        corner("stuck, accuracy 1e-4", damping={"contact": 10.0}, accuracy=1e-4, duration=1.0),
        corner("drag 100, accuracy 1e-4", damping={"beads": 100.0}, accuracy=1e-4, duration=1.0),
        corner("dashpots, two ranks", damping=dashpots, ranks=2),
        corner("dashpots, walls", damping=dashpots, walls={"left": "bead", "right": "rigid"}),
        corner("dashpots, hard wall", damping=dashpots, walls={"left": {"stiffness": 1e4}, "right": "flat"}),
        corner("dashpots, load", damping=dashpots, precompression={"force": 1.0}),
        corner("drag, load", damping={"beads": 0.1}, precompression={"force": 1.0}),
    ]


def _two_by_two(mass: float) -> Cell:
    kinds: Plain = {"kinds": {"one": {}, "other": {"mass": mass}}, "pattern": ["one", "other"]}
    return Cell("dimer", f"{mass:g}", changed(BASE, **kinds, duration=15.0))


def _impurity(mass: float) -> Cell:
    kinds: Plain = {"kinds": {"other": {"mass": mass}}, "replace": {"bead": 10, "kind": "other"}}
    return Cell("impurity", f"{mass:g}", changed(BASE, **kinds, duration=20.0))


def _exponent(exponent: float) -> Cell:
    return Cell("exponent", f"{exponent:g}", changed(BASE, contact={"exponent": exponent}, duration=20.0))


def _moved(frequency: float) -> Cell:
    """A bead that swings by 1."""
    drive: Plain = {"displacement": 1.0, "frequency": frequency, "phase": -90.0}
    return _driven("drive", frequency, drive)


def _forced(frequency: float) -> Cell:
    return _driven("drive, force", frequency, {"force": 1.0, "frequency": frequency})


def _driven(axis: str, frequency: float, drive: Plain) -> Cell:
    cycles = 1.0 if frequency < 0.01 else 3.0 if frequency < 1.0 else 30.0
    return Cell(axis, f"{frequency:g}", changed(BASE, kick=None, drive=drive, duration=cycles / frequency))
