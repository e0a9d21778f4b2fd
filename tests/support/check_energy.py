"""Energy, momentum and where they are, from the frames of a run and the true exchange of what is exchanged."""

from typing import Any

import numpy as np
from case import Case, instants, summed
from comparing import About, Either, Given, Holds, Unknown, column
from scene_keys import hardest

HELD = ("kinetic", "contacts", "springs", "ground", "walls")


def expected(case: Case) -> dict[str, Any]:
    """Keys of ``analysis.json``."""
    unit = case.unit
    found = {
        "complete": len(case.frames) == case.directory.wanted,
        "frames": [len(case.frames), case.directory.wanted],
        "front": front(case),
        "energy_drift": energy_drift(case),
        "momentum_drift": momentum_drift(case),
        "participation": participation(case),
        "units": "SI" if unit.si else "reduced",
        "scale": {name: About(getattr(unit, name)) for name in ("mass", "length", "time", "velocity")},
        "kappa": About(max((float(np.max(k)) for _, _, k, _ in case.nature.springs), default=0.0)),
        "noise": 0.0,
        "tolerances": {"shape": 0.01, "speed": 0.01, "amplitude": 0.01},
    }
    if case.exchanges and case.of_all is not None:
        found["budget"] = budget(case)
    if case.directory.whole and not case.pulse:
        found["energy"] = flow(case)
    return found


def front(case: Case) -> Any:
    """The largest number of a recorded bead that was ever faster than 1e-3 of V; null if none was."""
    speed = np.max(np.abs(np.nan_to_num(case.frames.v)), axis=(0, 1))
    beads = [int(np.flatnonzero(speed > 1e-3 * share).max(initial=-1)) + 1 for share in (1.0 - 1e-9, 1.0 + 1e-9)]
    return Either(tuple(bead or None for bead in beads))


def energy_drift(case: Case) -> Any:
    """Largest difference of the energy from what was put in less what was lost, over the most that was put in."""
    frames, own = case.of_all, case.nature
    if frames is None or len(frames) < 2:
        return None
    held = summed(own.held(frames.x, frames.v))
    if not case.exchanges:
        drift = np.max(np.abs(held / own.kick_energy - 1.0))
        return About(float(drift), 1e-9 * (1.0 + float(np.max(own.load)) ** 2))
    energy_input, lost = exchanged(case, frames.time)
    most = float(np.max(np.abs(energy_input)))
    missing = float(np.max(np.abs(held + summed(lost) - energy_input)))
    return About(missing / most, case.energy_off / most + 1e-9)


def participation(case: Case) -> Any:
    """How many beads share the energy of the last frame of all beads."""
    if case.of_all is None:
        return None
    energy = case.nature.of_beads(case.of_all.x[-1], case.of_all.v[-1])
    number = float(np.sum(energy) ** 2 / np.sum(energy**2))
    return About(number, 1e-9 * number * (1.0 + float(np.max(case.nature.load)) ** 2))


def exchanged(case: Case, time: Any) -> tuple[Any, dict[str, Any]]:
    """What was put in, and what dashpots took, until times."""
    lost = case.truth.exchange(time)
    energy_input = lost.pop("energy_input") + case.nature.kick_energy
    walls = {name: lost.pop(name) for name in list(lost) if "wall" in name}
    if walls:
        lost[" and ".join(walls)] = summed(walls)
    return energy_input, lost


def momentum_drift(case: Case) -> Any:
    """Where nothing but forces that are known acts from outside; relative to the sizes of all impulses."""
    frames, own, scene = case.of_all, case.nature, case.scene
    holds = not (scene.walls or scene.foundation or own.drag or own.moved)
    if scene.gravity is not None:
        holds = False
    if frames is None or len(frames) < 2 or not holds:
        return None
    momentum = np.sum(own.mass * frames.v, axis=(-2, -1))
    start = float(np.sum(own.mass * own.start))
    size = float(np.sum(own.mass * np.abs(own.start)))
    if not own.pushes:
        return About(float(np.max(np.abs(momentum - start))) / size, 1e-11)
    size += sum(abs(_given(push, np.array([min(push.ends, 1e9)]))[0]) for push in own.pushes if np.isfinite(push.ends))
    return Holds("a small number", lambda found: found is None or 0.0 <= found < 1e-6)


def _given(push: Any, time: Any) -> Any:
    nodes, weights = np.polynomial.legendre.leggauss(200)
    return np.array([0.5 * t * np.sum(weights * push.force(0.5 * t * (nodes + 1.0))) for t in time])


def budget(case: Case) -> dict[str, Any]:
    """See `workflow.verdicts.findings.energy`."""
    frames, own, unit = case.of_all, case.nature, case.unit
    assert frames is not None
    chosen = instants(frames, last=True)
    time = frames.time[chosen]
    held = own.held(frames.x[chosen], frames.v[chosen])
    energy_input, lost = exchanged(case, time)
    off = case.energy_off * unit.energy
    scaled = {name: column(part * unit.energy, 1e-11 * unit.energy) for name, part in held.items()}
    check = case.directory.record["check"]["velocity"]

    def missing(found: Any) -> Any:  # noqa: ARG001
        told = case.report["budget"]
        parts = [told[name] for name in HELD] + list(told["lost"].values())
        rest = np.array(told["energy_input"]) - np.sum(np.array(parts), axis=0)
        return column(rest, 1e-9 * unit.energy * (1.0 + float(np.max(np.abs(energy_input)))))

    return {
        "time": column(time * unit.time),
        "energy_input": column(energy_input * unit.energy, off),
        **scaled,
        "lost": {name: column(part * unit.energy, off) for name, part in lost.items()},
        "missing": Given(missing),
        "closed": Given(lambda _: About(case.report["energy_drift"])),
        "between_frames": Holds("a share", lambda found: 0.0 <= found < 1.0),
        "stated": About(check),
    }


def flow(case: Case) -> dict[str, Any]:
    """Where the energy is over time, at some of the frames."""
    frames, own = case.frames, case.nature
    chosen = instants(frames)
    x, v = frames.x[chosen], frames.v[chosen]
    energy = own.of_beads(x, v)
    chains = energy.sum(axis=-1)
    total = chains.sum(axis=-1, keepdims=True)
    share = np.divide(chains, total, out=np.zeros_like(chains), where=total > 0.0)
    beads = np.arange(1, case.scene.beads + 1)
    with np.errstate(invalid="ignore", divide="ignore"):
        weight = energy / chains[..., np.newaxis]
        centre = np.sum(weight * beads, axis=-1)
        spread = np.sqrt(np.sum(weight * (beads - centre[..., np.newaxis]) ** 2, axis=-1))
    between = sum((part.sum(axis=-1) for part in own.in_springs(x)), np.zeros(len(x)))

    def table(values: Any, within: float) -> list[list[Any]]:
        return [
            [
                About(float(value), within * 1e-9 / max(float(part), 1e-9)) if part > 1.1e-9
                else Holds("of next to nothing", lambda _: True) if part > 0.9e-9 else None
                for value, part in zip(row, parts, strict=True)
            ]
            for row, parts in zip(values, share, strict=True)
        ]  # fmt: skip

    return {
        "time": column(frames.time[chosen] * case.unit.time),
        "share": [column(row, 1e-10) for row in share],
        "between": [shared_out(case, *one) for one in zip(between, work_input(case, frames.time[chosen]), strict=True)],
        "centre": table(centre, 1e-3 * case.scene.beads),
        "spread": table(spread, 1.0 * case.scene.beads),
    }


def work_input(case: Case, time: Any) -> Any:
    """Energy of the kicks, and work of pushes and drives until times."""
    return exchanged(case, time)[0] if case.acted_on else np.full(np.shape(time), case.nature.kick_energy)


def shared_out(case: Case, energy: float, energy_input: float) -> Any:
    """A share of what was put in; null where that is nothing, unknown where it may be."""
    off = case.energy_off if case.acted_on else 1e-12
    if energy_input < 10.0 * off:
        return Unknown("next to nothing was put in") if energy_input > -off else None
    return About(energy / energy_input, (off + abs(energy) / energy_input * off) / energy_input)


def hit(case: Case) -> tuple[int, int]:
    """Chain and bead of the hardest blow, from 1."""
    chain, bead, _ = hardest(case.scene)
    return chain, bead
