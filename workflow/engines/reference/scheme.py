"""What a splitting scheme is: two rows of numbers."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Scheme:
    """One time step h as kicks (v += kick * h * a) and drifts (x += drift * h * v), taken in turn, a kick first.

    A leading or trailing kick of 0 makes the scheme start or end with a drift.
    """

    name: str
    order: int
    """Order for smooth forces; contacts that open and close limit every scheme to 2.5 at small steps."""
    kicks: tuple[float, ...]
    drifts: tuple[float, ...]
    source: str

    def __post_init__(self) -> None:
        if len(self.kicks) != len(self.drifts) + 1:
            raise ValueError(f"{self.name}: a scheme has one kick more than drifts")

    @property
    def forces_per_step(self) -> int:
        """Force evaluations a step costs; a last kick shares its forces with the next step's first."""
        return len(self.drifts) if self.kicks[0] else len(self.drifts) - 1
