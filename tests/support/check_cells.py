"""Chains of unlike beads: what the leading pulse carries and loses, and where the energy is about a replaced bead."""

import math
from typing import Any

import numpy as np
from case import Case
from check_sharing import energy_input
from check_waves import CLEAR, near_energy, period, reach, tied
from comparing import About, Either, Given, Holds, Unknown
from scene_keys import blows, hardest


def expected(case: Case) -> dict[str, Any]:
    """Key of ``analysis.json``."""
    own = case.nature
    alike = np.all(own.mass == 1.0) and np.ptp(own.strength) == 0.0
    if not case.directory.whole or alike or not case.pulse or own.loaded:
        return {}
    return {"cells": cells(case)}


def cells(case: Case) -> dict[str, Any]:
    """See `workflow.verdicts.findings.pulses`."""
    chains = range(1, case.scene.chains + 1)

    def residual_energy(found: Any) -> Any:  # noqa: ARG001
        told = case.report["cells"]["chains"][hardest(case.scene)[0] - 1]
        return About(None if told is None else told["per_cell"])

    return {
        "beads": period(case),
        "residual_energy": Given(residual_energy),
        "chains": [Given(lambda found, chain=chain: left(case, chain, found)) for chain in chains],
        "last_bead": [last_bead(case, chain) for chain in chains],
        "replaced": [
            Given(lambda found, at=one: split(case, at.chain, at.bead, found)) for one in case.scene.replace or ()
        ],
    }


def along(case: Case, bead: int) -> int:
    return bead if case.way > 0 else case.scene.beads + 1 - bead


def alone(case: Case, chain: int) -> bool:
    """Whether a chain exchanges energy with nothing."""
    own = case.nature
    return not own.lossy and not any(chain - 1 in (a, b) for a, b, *_ in own.springs)


def shares(case: Case, chain: int) -> dict[int, tuple[float, bool]]:
    """Bead along the way -> share of the energy near the leading wave's peak, and whether no other pulse is as near."""
    energy, _ = energy_input(case)
    found = {}
    first = max(along(case, bead) for _, bead, blow in blows(case.scene) if blow * case.way > 0.0)
    for row in case.directory.table("waves.csv"):
        bead = int(row["bead"])
        if row["chain"] == chain and along(case, bead) > first and row["arrival"] is not None:
            time = row["arrival"] / case.unit.time
            found[along(case, bead)] = near_energy(case, chain, bead, time) / energy, row["wave_energy"] is not None
    return found


def left(case: Case, chain: int, found: Any) -> Any:
    """The leading pulse at two beads whole cells apart, that are named."""
    if found is None:
        return None
    if case.nature.gap > 0.0:
        return {name: Unknown("centres of impulses") for name in found}
    known, cell = shares(case, chain), period(case)
    first, last = along(case, found["first"]), along(case, found["last"])
    if first not in known or last not in known:
        return {name: Unknown("which maxima") for name in found}
    _, off = energy_input(case)
    within = 1e-9 + 2.0 * off / energy_input(case)[0]
    count = (last - first) // cell
    lost = (known[first][0] - known[last][0]) / count if count else None
    like = [bead for bead in known if first <= bead <= last and (last - bead) % cell == 0 and known[bead][1]]
    if found["per_cell"] is None or lost is None:
        fit = rate = None
    elif len(like) < 3:
        rate = fit = Either((None, Unknown("few")))
    else:
        number, value = (np.array(like) - first) / cell, np.log([known[bead][0] for bead in like])
        line = np.polynomial.Polynomial.fit(number, value, 1)
        slope = float(line.deriv()(0.0))
        rate, fit = (
            About(-math.expm1(slope), within),
            About(float(np.max(np.abs(np.exp(value - line(number)) - 1.0))), within),
        )
        if {first, last} - set(like) or len(like) < count + 1:
            rate = fit = Either((rate, Unknown("where another pulse is near")))
    apart = Holds(
        "whole cells from the last",
        lambda value: (last - along(case, value)) % cell == 0 and along(case, value) <= last,
    )
    return {
        "first": apart,
        "last": Holds("clear of the end", lambda value: along(case, value) <= case.scene.beads - CLEAR),
        "carried": About(known[last][0], within),
        "per_cell": Either((None, About(lost, within))) if alone(case, chain) and lost is not None else None,
        "rate": rate,
        "deviation": fit,
    }


def last_bead(case: Case, chain: int) -> Any:
    """Its largest kinetic energy in any frame, where a wave came there."""
    end = case.scene.beads if case.way > 0 else 1
    rows = case.directory.table("waves.csv")
    if not any((row["chain"], row["bead"]) == (chain, end) for row in rows):
        return None
    energy, off = energy_input(case)
    most = float(np.max(case.nature.kinetic(case.frames.v)[:, chain - 1, end - 1]))
    return About(most / energy, 1e-12 + most / energy**2 * 2.0 * off)


def split(case: Case, chain: int, bead: int, found: Any) -> dict[str, Any]:
    """Where the energy is in the last frame, and what of the pulse before the bead is on its side."""
    energy, off = energy_input(case)
    share = case.nature.of_beads(case.frames.x[-1], case.frames.v[-1])[chain - 1] / energy
    parts = float(share[: bead - 1].sum()), float(share[bead - 1]), float(share[bead:].sum())
    within = 1e-10 + 4.0 * off / energy
    known = shares(case, chain)
    before = sorted((place for place in known if place < along(case, bead) - reach(case)), reverse=True)
    gone = parts[2] if case.way > 0 else parts[0]
    incident = found["incident"]
    return {
        "chain": chain,
        "bead": bead,
        **{name: About(value, within) for name, value in zip(("before", "at", "beyond"), parts, strict=True)},
        "incident": Either((None, *(About(known[place][0], within) for place in before[:12]))),
        "reflected": None
        if incident is None or not alone(case, chain) or len(tied(case)) > 1
        else Either((None, About(incident - parts[1] - gone, 2.0 * within))),
    }
