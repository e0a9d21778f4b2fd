"""Numbers that no bead has: those that are refused, those that are unlikely, and the unit that was probably meant.

A number in another unit than SI is off by powers of ten, which the dimensionless problem does not show. The limits here
are of nature, wide enough for foam, hydrogel, rubber, glass, tungsten carbide and diamond.
"""

FASTEST_SOUND = 36.1e3
"""m/s. No solid or liquid has a faster sound: ``alpha sqrt(m_e / 2 m_p) c`` (Trachenko, Monserrat, Pickard & Brazhkin,
Science Advances 6, eabc8662, 2020). In a thin bar of diamond it is half of that.
"""

AIR = 1.2
"""kg/m3. A solid that is lighter would rise in it."""

OSMIUM = 22_590.0
"""kg/m3, the densest element."""

HEAVIEST = 1e5
"""kg/m3. Spheres that carry something else may be denser than osmium, but hardly four times."""

GRAVITY = 9.81
"""m/s2. A sphere does not keep its shape where the pressure of its weight exceeds its modulus."""

DIAMOND = 1.3e12
"""Pa, a little above the stiffest solids."""

GEL = 1e3
"""Pa, of soft gels."""

STIFF, DENSE = 1e9, 2300.0
"""Pa and kg/m3. Solids denser than polymers are stiffer than this, but for rubber that is filled with metal."""

FOAM = 10.0
"""kg/m3, of the lightest foams."""

LARGE = 0.5
"""m, a metal bead of four tons."""


def impossible(radius: float, density: float, youngs_modulus: float) -> str:
    """Key of a number that no solid sphere has, and why, with the unit that was probably meant; empty if one may.

    Args:
        radius: in m.
        density: in kg/m3.
        youngs_modulus: in Pa.
    """
    sound, weight = (youngs_modulus / density) ** 0.5, density * GRAVITY * radius
    light = 1e3 * density < OSMIUM
    if density > HEAVIEST:
        return f"density: {density:g} kg/m3 is more than that of any solid (osmium: {OSMIUM:g} kg/m3)"
    if density < AIR:
        return f"density: {density:g} kg/m3 is less than that of air ({AIR:g} kg/m3); {_in_grams(density)}"
    if sound > FASTEST_SOUND:
        why = f"sqrt(youngs_modulus / density) = {sound:.3g} m/s; sound in solids is below {FASTEST_SOUND:g} m/s"
        return f"density: {why}; {_in_grams(density)}" if light else f"youngs_modulus: {why}; is it in Pa?"
    if weight > youngs_modulus:
        why = f"{youngs_modulus:g} Pa is less than a bead's weight exerts, density * 9.81 * radius = {weight:.3g} Pa"
        return f"youngs_modulus: {why}; youngs_modulus in Pa? {_in_gigapascals(youngs_modulus)}"
    return ""


def unlikely(radius: float, density: float, youngs_modulus: float) -> list[str]:
    """What is unlikely in a bead, and what it is if another unit was meant; arguments as of `impossible`."""
    found = []
    if youngs_modulus < GEL:
        why = f"{youngs_modulus:g} Pa is softer than gels ({GEL:g} Pa); {_in_gigapascals(youngs_modulus)}"
        found.append(f"youngs_modulus in Pa? {why}")
    elif youngs_modulus < STIFF and density > DENSE:
        meant = f"{youngs_modulus:g} MPa is {1e6 * youngs_modulus:g} Pa"
        if 1e9 * youngs_modulus < DIAMOND:
            meant = _in_gigapascals(youngs_modulus)
        found.append(f"youngs_modulus in Pa? {youngs_modulus:g} Pa is soft for {density:g} kg/m3; {meant}")
    elif youngs_modulus > DIAMOND:
        found.append(f"youngs_modulus in Pa? {youngs_modulus:g} Pa is stiffer than diamond")
    if density < FOAM:
        found.append(f"density in kg/m3? {density:g} kg/m3 is lighter than foam; {_in_grams(density)}")
    elif density > OSMIUM:
        found.append(f"density in kg/m3? {density:g} kg/m3 is more than that of osmium")
    if radius > LARGE:
        found.append(f"radius in m? {radius:g} m is large for a bead; {radius:g} mm is {1e-3 * radius:g} m")
    return found


def _in_gigapascals(youngs_modulus: float) -> str:
    return f"{youngs_modulus:g} GPa is {1e9 * youngs_modulus:g} Pa"


def _in_grams(density: float) -> str:
    return f"{density:g} g/cm3 is {1e3 * density:g} kg/m3"
