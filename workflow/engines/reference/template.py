"""The text of the reference integrator's compiled step, with places for the laws of a system.

| paper                       | here                   | shape                  |
|-----------------------------|------------------------|------------------------|
| x_i^(j)                     | ``x[k]``               | [bead + 2, chain] flat |
| its first derivative        | ``v[k]``               | [bead + 2, chain] flat |
| (x_{i-1} - x_i - D)+^1.5    | ``push[k]``            | [bead + 2, chain] flat |
| others                      | places in braces       |                        |

All dimensionless. Row i holds bead i of every chain; rows 0 and beads + 1 stay at zero. So any range of rows is one
piece of memory, and each loop runs over it without branches and becomes vector instructions. Positions in memory are
unsigned, which spares the loops a test for negative ones.

A place is a name in braces. One that is alone in its line stands for any number of lines, none included. A line that
begins with a question mark and a name is there only if that is true. What a system does not have is not in its text.
"""

HEAD = '''
"""Compiled step of the reference integrator for one set of laws; written by workflow.engines.reference.kernel."""

# sources of the laws: {digest}
from functools import partial

from numpy import isnan, uint64

from workflow.compiled import called_by_compiled, compiled, inlined
from workflow.engines.reference.common import displaced, maximum, over_the_way
{imports}

{laws}
'''

PRESS = """
for k in range(low + {row}, high):
    push[k] = {contact}
{walls}
"""

KICK = """
{loops}
for k in range(low, high):
    {target}[k] += {factor} * ((push[k] - push[k + {row}]{others}){per_mass})
"""

SUM = """
for k in range(low, high):
    {total} = 0.0
for m in range({over}.shape[0]):
    apart = {over}[m]
    for k in range(low, high):
        {total} += {call}
"""

STEP = """
for stage in range(kicks.shape[0]):
    low, high = uint64(span[0] * chains), uint64((span[1] + 1) * chains)
    if kicks[stage] != 0.0:
        factor = kicks[stage] * h
        if span[3]:
            {press}
            ?half_step brake(x, v, p, squeeze, drag, low, high)
            span[3] = 0
        {kick}
        {kick_by_means}
        {hold}
        ?reset known = False
        {tangent_kick}
    if stage < drifts.shape[0]:
        duration = drifts[stage] * h
        {tangent_drift}
        {drift}
        time += duration
        span[3] = 1
        first, last = span[0], span[1]
        if (last + 2) * chains < x.shape[0] and displaced(x, last * chains, (last + 1) * chains):
            last += 1
            if last - first >= span[2]:
                first = last - span[2] + 1
                push[first * chains : (first + 1) * chains] = 0.0
        if first > 1 and last - first + 1 < span[2] and displaced(x, first * chains, (first + 1) * chains):
            first -= 1
        ?drifting known = span[0] == first and span[1] == last
        span[0], span[1] = first, last
?reset known = False
{updated}
"""

SPLIT = """
whole_step, end_of_step = h, time + h
for bend in range({bends}.shape[0] + 1):
    stop = min(max({bends}[bend], time), end_of_step) if bend < {bends}.shape[0] else end_of_step
    if stop > time:
        h = stop - time
        {step}
        time = stop
h = whole_step
"""

SPAN = """
low, high = uint64(span[0] * chains), uint64((span[1] + 1) * chains)
"""

NOTE = """
for k in range({begin}, {end}):
    {was} = {strain}
    {closing} = {rate}
"""

UPDATE = """
# a contact that begins to open within the step: from then on its force is that in the state of the largest overlap;
# where none can exceed its state, which the control points of the cubic polynomial show, nothing is to be done
opening = 0
for k in range({begin}, {end}):
    late, fall = {strain}, {rate}
    late = max({was} + {closing} * h / 3.0, late - fall * h / 3.0)
    opening += ({closing} > 0.0) & (fall <= 0.0) & ({after} > {contact_state})
for k in range({begin}, {end} if opening > 0 else {begin}):
    late, fall = {strain}, {rate}
    if {closing} > 0.0 and fall <= 0.0:
        rise, fall = {closing} * h, fall * h
        share, top = maximum({was}, late, rise, fall)
        before, largest = {contact_state}, {top}
        if largest > before:
            square, cube = 3.0 * (late - {was}) - 2.0 * rise - fall, 2.0 * ({was} - late) + rise + fall
            given, gone, remains = 0.0, 0.0, 1.0 - share
            for node, weight in ((0.1127016653792583, 5.0), (0.5, 8.0), (0.8872983346207417, 5.0)):
                at = share + remains * node
                s = {was} + at * (rise + at * (square + at * cube))
                change = (({more}) - ({less})) * weight / 18.0 * remains * h
                given += change
                gone += change * (1.0 - at) * h
            given, gone = {sign}given, {sign}gone
            v[k] += given{per_mass}
            x[k] += gone{per_mass}
            {behind}
            {contact_state} = largest
for k in range({begin}, {end}):
    late = {strain}
    {contact_state} = {after}
    {was} = late
    {closing} = {rate}
span[3] = 1
"""

UPDATE_AS_LAMMPS = """
for k in range({begin}, {end}):
    late = {strain}
    {contact_state} = {after}
"""

ADVANCE = '''
@partial(compiled, nogil=True)  # other threads of Python go on meanwhile
def advance(state, p, scheme, first_step, steps, recorded, frames):
    """Advance a state by as many frames as are to be filled, so many steps each; see `kernel.Kernel`."""
    {parameters}
    {unpacked}
    {before}
    for frame in range(frames.x.shape[0]):
        for number in range(frame * steps, (frame + 1) * steps):
            time = (first_step + number) * h
            {split_step}
        {velocities}
        for j in range(frames.x.shape[1]):
            for k in range(recorded.shape[0]):
                frames.x[frame, j, k] = x[recorded[k] * chains + j]
                frames.v[frame, j, k] = {actual}[recorded[k] * chains + j]
        ?counts_lost for kind in range(4):
        ?counts_lost     frames.exchange[frame, kind] = 0.0
        ?counts_lost     for k in range(lost.shape[1]):
        ?counts_lost         frames.exchange[frame, kind] += lost[kind, k]
        ?has_state for j in range(frames.contact_state.shape[1]):
        ?has_state     for k in range(frames.contact_state.shape[2]):
        ?has_state         frames.contact_state[frame, j, k] = contact_state[(k + 1) * chains + j]
        {held_by_dashpots}
        ?counts_work frames.exchange[frame, 4] = work[0]
        ?moved_with_loss frames.exchange[frame, 4] += held
'''

UNPACKED = """
x, v, push, span, chains, room, lost, work, past = state
?has_state contact_state, was, closing = past
?damped {rooms} = room
kicks, drifts, h = scheme
?drifting known = False
"""

FOLLOW = '''
@partial(compiled, nogil=True)
def follow(state, p, scheme, first_step, steps, threshold, passing):
    """Take some steps and note the first maximum of every bead."""
    {parameters}
    {unpacked}
    arrival, peak, a, a_before, v_before = passing
    {velocities}
    {before}
    for number in range(first_step, first_step + steps):
        time = number * h
        for k in range(uint64(span[0] * chains), uint64((span[1] + 1) * chains)):
            v_before[k] = {actual}[k]
            a_before[k] = a[k]
        span[3] = 1
        {step}
        {velocities}
        time = (number + 1) * h
        low, high = uint64(span[0] * chains), uint64((span[1] + 1) * chains)
        {press}
        for k in range(low, high):
            a[k] = 0.0
        {kick}
        ?damped brake(x, {actual}, p, squeeze, drag, low, high)
        ?damped for k in range(low, high):
        ?damped     a[k] += drag[k]{per_mass}
        ?pushed load(a, p, time, low, high)
        for k in range(low, high):
            if isnan(arrival[k]) and a_before[k] > 0.0 and a[k] <= 0.0:
                part, top = maximum(v_before[k], {actual}[k], a_before[k] * h, a[k] * h)
                if top > threshold:
                    arrival[k] = time - h + part * h
                    peak[k] = top
'''

DRIFT = """
for k in range(low, high):
    x[k] += duration * v[k]
{loads}
"""

TRAVEL = '''
@called_by_compiled
def {name}travel(x, {arguments}, time, duration, low, high):
    """How much farther free beads drift under loads in a duration."""
    {parameters}
    {travels}


@called_by_compiled
def {name}give(v, {arguments}, time, duration, low, high):
    """How much faster they get."""
    {parameters}
    {gifts}
'''

LOAD = '''
@called_by_compiled
def load(a, p, time, low, high):
    """Add loads at a time to accelerations."""
    {parameters}
    {loads}
'''

DRAG = '''
@called_by_compiled
def {name}({arguments}, squeeze, drag, low, high):
    """{what} of all dashpots on the beads of rows that can move, into ``drag``; beads beside them are at rest."""
    {parameters}
    {contacts}
    {loops}
    for k in range(low, high):
        drag[k] = {drag}
'''

CONTACT_DRAG = """
for k in range(low, low + {row}):
    squeeze[k] = 0.0
for k in range(low + {row}, high):
    squeeze[k] = {contact}
for k in range(high, high + {row}):
    squeeze[k] = 0.0
{walls}
"""

DRAG_AS_LAMMPS = """
for k in range(low, high):
    v[k] += factor * (drag[k]{per_mass})
"""

KICK_WITH_DRAG = """
# classical Runge-Kutta method for v' = (forces + drag(v)) / masses
for k in range(low, high):
    steady[k] = 0.0
    total[k] = 0.0
    trial[k] = v[k]
{kick}
for part in range(4):
    brake(x, trial, p, squeeze, drag, low, high)
    count = factor / (3.0 if 0 < part < 3 else 6.0)
    for k in range(low, high):
        lost[0, k] -= count * trial[k] * drag[k]
    {taken}
    if part < 3:
        weight, ahead = 2.0 if part > 0 else 1.0, factor if part == 2 else 0.5 * factor
        for k in range(low, high):
            slope = steady[k] + drag[k]{per_mass}
            total[k] += weight * slope
            trial[k] = v[k] + ahead * slope
for k in range(low, high):
    v[k] += factor / 6.0 * (total[k] + steady[k] + drag[k]{per_mass})
"""

DRIFT_WITH_IMPULSES = """
# v stands for v - impulses / masses; classical Runge-Kutta method for x' = v + impulses(x) / masses
for k in range(low, high):
    place[k] = x[k]
    trial[k] = x[k]
    total[k] = 0.0
for part in range(4):
    if part > 0 or not known:
        impulses(trial, p, squeeze, drag, low, high)
    else:  # as at the end of the drift before
        for k in range(low, high):
            drag[k] = after[k]
    if part == 0:
        for k in range(low, high):
            early[k] = v[k] + drag[k]{per_mass}
            start[k] = drag[k]
    if part < 3:
        weight, ahead = 2.0 if part > 0 else 1.0, duration if part == 2 else 0.5 * duration
        for k in range(low, high):
            slope = v[k] + drag[k]{per_mass}
            total[k] += weight * slope
            trial[k] = place[k] + ahead * slope
        ?pushed travel(trial, p, time, ahead, low, high)
for k in range(low, high):
    x[k] += duration / 6.0 * (total[k] + v[k] + drag[k]{per_mass})
?pushed travel(x, p, time, duration, low, high)
?pushed give(v, p, time, duration, low, high)
# energy that dashpots have taken, from the impulses at the start, in the middle and at the end
for part in range(2):
    impulses(x if part == 0 else trial, p, squeeze, drag, low, high)
    if part == 0:
        for k in range(low, high):
            after[k] = drag[k]
            actual[k] = v[k] + drag[k]{per_mass}
            trial[k] = 0.5 * (place[k] + x[k]) + 0.125 * duration * (early[k] - actual[k])
for k in range(low, high):
    total[k] = v[k] + drag[k]{per_mass}
?pushed give(total, p, time + duration, -0.5 * duration, low, high)
{counted}
for k in range(low, high):
    lost[0, k] -= over_the_way(early[k], total[k], actual[k], drag[k] - start[k], after[k] - drag[k])
{taken}
"""

VELOCITIES = """
low, high = uint64(span[0] * chains), uint64((span[1] + 1) * chains)
impulses(x, p, squeeze, drag, low, high)
for k in range(low, high):
    actual[k] = v[k] + drag[k]{per_mass}
"""

TANGENT = '''
@compiled
def advance_tangent(state, tangent, p, scheme, first_step, steps):
    """Advance a state and tangent vectors by some steps; see `kernel.TangentArrays`."""
    {parameters}
    {unpacked}
    dx, dv, slopes, pulls, stiffness, nearby, gains, rates = tangent
    for number in range(first_step, first_step + steps):
        time = number * h
        {split_step}
'''

DERIVATIVES = '''
@compiled
def advance_derivatives(state, tangent, p, scheme, first_step, steps, shift, recorded, frames):
    """Advance a state and its derivatives by as many frames as are to be filled; see `kernel.ShiftArrays`."""
    {parameters}
    {unpacked}
    dx, dv, slopes, pulls, stiffness, nearby, gains, rates = tangent
    q, weights, differs, first_side = shift
    for frame in range(frames.x.shape[0]):
        for number in range(frame * steps, (frame + 1) * steps):
            time = (first_step + number) * h
            {split_step}
        for j in range(frames.x.shape[1]):
            for k in range(recorded.shape[0]):
                frames.x[frame, j, k] = x[recorded[k] * chains + j]
                frames.v[frame, j, k] = v[recorded[k] * chains + j]
                for n in range(dx.shape[0]):
                    frames.dx[n, frame, j, k] = dx[n, recorded[k] * chains + j]
                    frames.dv[n, frame, j, k] = dv[n, recorded[k] * chains + j]
'''

SHIFTED_KICK = '''
@called_by_compiled
def shifted_kick(dv, x, q, s, factor, time, differs, pulls, low, high):
    """Add the kick of shifted parameters, times a factor."""
    {parameters}
    if differs[0]:
        for k in range(low + {row}, high):
            pulls[k] = {contact}
        {walls}
        for k in range(low, high):
            dv[k] += factor * ((pulls[k] - pulls[k + {row}]){per_mass})
    if differs[1]:
        {loops}
        for k in range(low, high):
            dv[k] += factor * ((0.0{others}){per_mass})
'''

SHIFTED_RATE = '''
@called_by_compiled
def shifted_rate(rates, x, q, s, factor, squeeze, drag, low, high):
    """Add the rate of displacements by dashpots of shifted parameters, times a factor."""
    {parameters}
    shifted_impulses(x, q, s, squeeze, drag, low, high)
    for k in range(low, high):
        rates[k] += factor * (drag[k]{per_mass})
'''

TANGENT_KICK = """
for k in range(low + {row}, high):
    slopes[k] = {contact_slope}
{wall_slopes}
{stiffness}
for n in range(dx.shape[0]):
    dx_n, dv_n = dx[n], dv[n]
    for k in range(low + {row}, high):
        pulls[k] = slopes[k] * (dx_n[k - {row}] - dx_n[k])
    {wall_pulls}
    {loops}
    for k in range(low, high):
        dv_n[k] += factor * ((pulls[k] - pulls[k + {row}]{others}){per_mass})
    ?shifted if differs[n, 0] or differs[n, 1]:
    ?shifted     for s in range(first_side[n], first_side[n + 1]):
    ?shifted         shifted_kick(dv_n, x, q, s, weights[s] * factor, time, differs[n], pulls, low, high)
"""

TANGENT_DRIFT = """
for n in range(dx.shape[0]):
    dx_n, dv_n = dx[n], dv[n]
    for k in range(low, high):
        dx_n[k] += duration * dv_n[k]
    {loads_of_sides}
"""

SHIFTED_LOADS = """
if differs[n, 3]:
    for s in range(first_side[n], first_side[n + 1]):
        shifted_travel(dx_n, q, s, weights[s], time, duration, low, high)
        shifted_give(dv_n, q, s, weights[s], time, duration, low, high)
"""

TANGENT_DRIFT_WITH_IMPULSES = """
# the linearised drift, by the same Runge-Kutta method: the slope of an impulse is the drag at a rate of 1
for k in range(low, high):
    place[k] = x[k]
    trial[k] = x[k]
for n in range(dx.shape[0]):  # not as arrays: numba would compile the message of shapes that differ, for seconds
    for k in range(dx.shape[1]):
        nearby[n, k] = dx[n, k]
        gains[n, k] = 0.0
for part in range(4):
    weight, later = 2.0 if 0 < part < 3 else 1.0, duration if part == 2 else 0.5 * duration
    for n in range(dx.shape[0]):
        dx_n, dv_n, nearby_n, gains_n = dx[n], dv[n], nearby[n], gains[n]
        brake(trial, nearby_n, p, squeeze, drag, low, high)
        for k in range(low, high):
            rates[k] = dv_n[k] + drag[k]{per_mass}
        ?shifted if differs[n, 2]:
        ?shifted     for s in range(first_side[n], first_side[n + 1]):
        ?shifted         shifted_rate(rates, trial, q, s, weights[s], squeeze, drag, low, high)
        for k in range(low, high):
            gains_n[k] += weight * rates[k]
            nearby_n[k] = dx_n[k] + later * rates[k]
        ?shifted_loads if differs[n, 3]:
        ?shifted_loads     for s in range(first_side[n], first_side[n + 1]):
        ?shifted_loads         shifted_travel(nearby_n, q, s, weights[s], time, later, low, high)
    impulses(trial, p, squeeze, drag, low, high)
    for k in range(low, high):
        trial[k] = place[k] + later * (v[k] + drag[k]{per_mass})
    ?pushed travel(trial, p, time, later, low, high)
for n in range(dx.shape[0]):
    dx_n, dv_n, gains_n = dx[n], dv[n], gains[n]
    for k in range(low, high):
        dx_n[k] += duration / 6.0 * gains_n[k]
    {loads_of_sides}
"""
