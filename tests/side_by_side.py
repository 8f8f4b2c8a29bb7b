"""Times our strut and our vehicle beside those of others, on one machine and in one run.

    side_by_side.py STRUT VEHICLE [--rounds N]

STRUT is the program of benches/solvers, VEHICLE the example vehicle_side_by_side of plant-sim. One strut is moved in one way, by our solver, by diffsol's BDF
(in Rust) and by SciPy's Radau, BDF and LSODA. Each gets the coarsest setting with which p1 to p4 stay within a stated deviation of a solution that
is far more accurate, so that what is compared is the time for the same result. The right-hand side is written here a second time, from
docs/physics.md. Then a vehicle makes a step of steer on a flat road: ours, and the multi-body model of CommonRoad. Measured is processor time, without the start of
programs. The rounds go round all programs, so that a disturbance of the machine meets all of them. Printed are tables in Markdown; the exit status is 1 if a result is not the same.
"""

import argparse
import bisect
import functools
import math
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time
import tomllib

import numpy
from scipy.integrate import solve_ivp

# SciPy widens the step of a numerical derivative by which nothing changes until it overflows, which does no harm.
numpy.seterr(over="ignore")

INTERVAL_S = 2e-3
SAMPLES = 1500
RESPONSE_S = 0.05
CASES = ["soft, low damping", "soft, high damping", "stiff, then valve 3 opens"]
VALVE_3_FROM_S = [-math.inf, -math.inf, 1.5]
DAMPERS_OPEN = [True, False, True]
ATMOSPHERE_PA = 101325.0
R, CV = 296.8, 743.0
# Largest deviations that are asked for, relative.
TARGETS = [1e-3, 1e-4]
# Steps of ours in an interval of 2 ms, and tolerances, the coarsest first.
STEPS = [1, 2, 4, 8, 16, 32]
TOLERANCES = [10.0 ** (-k / 2) for k in range(4, 21)]
TIMES = INTERVAL_S * numpy.arange(1, SAMPLES + 1)
# Repeats within a process, so that its start counts little.
REPEATS = {"oleo": 100, "bdf": 30}
# Calls of the right-hand side that the program makes in a repeat.
CALLS = 1_000_000


class Strut:
    """The equations of docs/physics.md with the terms that the comparison has, in plain Python."""

    def __init__(self, model, case):
        self.edge = VALVE_3_FROM_S[case]
        self.area = math.pi / 4 * model["cylinder"]["bore_m"] ** 2
        self.oil = model["cylinder"]["oil_volume_m3"]
        self.static = model["cylinder"]["static_pressure_Pa"]
        self.beta = model["effects"]["oil_compressibility"]["bulk_modulus_Pa"]
        self.ambient = model["gas"]["temperature_K"]
        heat = model["effects"]["gas_heat_transfer"]
        self.tau = (heat["time_constant_1_s"], heat["time_constant_2_s"])
        self.volume = tuple(a["static_gas_volume_m3"] for a in model["accumulator"])
        self.mass_r = tuple((self.static + ATMOSPHERE_PA) * v / self.ambient for v in self.volume)
        self.coefficient = tuple(v["flow_coefficient"] * v.get("in_parallel", 1) for v in model["valve"])
        self.bypass = self.coefficient[:2] if DAMPERS_OPEN[case] else (0.0, 0.0)
        self.transition = model["orifice"]["transition_pressure_Pa"]
        self.packs = []
        for damper in model["damper"]:
            drop, flow = damper["pressure_drop_Pa"], damper["flow_m3_s"]
            slopes = [(q1 - q0) / (d1 - d0) for d0, d1, q0, q1 in zip(drop, drop[1:], flow, flow[1:])]
            self.packs.append((drop[1:-1], [(q - s * d, s) for q, s, d in zip(flow, slopes, drop)]))
        self.calls = 0

    def damper(self, i, drop):
        inner, lines = self.packs[i]
        offset, slope = lines[bisect.bisect_left(inner, drop)]
        a = abs(drop) + self.transition
        root = math.sqrt(a)
        flow = offset + slope * drop + self.bypass[i] * drop / root
        return flow, slope + self.bypass[i] * (0.5 * abs(drop) + self.transition) / (a * root)

    def opening(self, t):
        delay = 0.4 * RESPONSE_S
        return min(1.0, max(0.0, 0.05 + 0.9 * (t - self.edge - delay) / (RESPONSE_S - delay)))

    def p3(self, p1, p4, opening):
        c3 = opening * self.coefficient[2]
        low, high = min(p1, p4), max(p1, p4)
        m = 0.5 * (low + high)
        for _ in range(60):
            flow, slope = self.damper(1, p1 - m)
            drop = m - p4
            a = abs(drop) + self.transition
            root = math.sqrt(a)
            left = flow - c3 * drop / root
            low, high = (m, high) if left > 0 else (low, m)
            step = m + left / (slope + c3 * (0.5 * abs(drop) + self.transition) / (a * root))
            if not low < step < high:
                step = 0.5 * (low + high)
            if abs(step - m) < 0.1:
                return step
            m = step
        return m

    def flows(self, t, y):
        p1 = 1e6 * y[0]
        p2 = self.mass_r[0] * y[2] / (1e-4 * y[1]) - ATMOSPHERE_PA
        p4 = self.mass_r[1] * y[4] / (1e-4 * y[3]) - ATMOSPHERE_PA
        q1 = self.damper(0, p1 - p2)[0]
        opening = self.opening(t)
        if opening <= 0.0:
            return q1, 0.0, (p1, p2, p1, p4)
        p3 = self.p3(p1, p4, opening)
        return q1, self.damper(1, p1 - p3)[0], (p1, p2, p3, p4)

    def slope(self, t, y):
        self.calls += 1
        y = y.tolist() if isinstance(y, numpy.ndarray) else y
        x, v = displacement(t)
        q1, q2, _ = self.flows(t, y)
        heat = R / CV
        return [
            1e-6 * self.beta / (self.oil - self.area * x) * (self.area * v - q1 - q2),
            -1e4 * q1,
            y[2] * heat * q1 / (1e-4 * y[1]) - (y[2] - self.ambient) / self.tau[0],
            -1e4 * q2,
            y[4] * heat * q2 / (1e-4 * y[3]) - (y[4] - self.ambient) / self.tau[1],
        ]

    def start(self):
        return [1e-6 * self.static, 1e4 * self.volume[0], self.ambient, 1e4 * self.volume[1], self.ambient]

    def pressures(self, states):
        return numpy.array([self.flows(t, y)[2] for t, y in zip(TIMES, states.T.tolist())])


SINES = [(a, 2 * math.pi * hz, ph, math.sin(ph)) for a, hz, ph in [(0.02, 1.1, 0.3), (0.008, 3.7, 1.1), (0.003, 8.9, 2.0)]]


def displacement(t):
    ramp, slope = ((t / 0.5) ** 2 * (3 - 2 * t / 0.5), 24 * t * (1 - 2 * t)) if t < 0.5 else (1.0, 0.0)
    x = v = 0.0
    for amplitude, w, phase, at_zero in SINES:
        s, c = math.sin(w * t + phase) - at_zero, math.cos(w * t + phase)
        x += amplitude * s * ramp
        v += amplitude * (w * c * ramp + s * slope)
    return x, v


def call(program, *words):
    """Processor time and output of a program that runs once."""
    with tempfile.TemporaryFile("w+") as out:
        process = subprocess.Popen([program, *map(str, words)], stdout=out)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        said = dict(line.split() for line in out)
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, program)
    return used.ru_utime + used.ru_stime, said


@functools.cache
def start_s(program, *words):
    """Processor time for starting a program, with no repeat of its work."""
    return min(call(program, *words[:-2], 0, words[-1])[0] for _ in range(5))


def repeated(program, *words):
    """Processor time of one repeat of a program's work, without its start, and its output. The last word but one is the number of repeats."""
    start = start_s(program, *words)
    spent, said = call(program, *words)
    return (spent - start) / int(words[-2]), said


class Solver:
    """One program with one setting: what it computes, and what that costs."""

    def __init__(self, name, settings, run):
        self.name, self.settings, self.run = name, settings, run

    def coarsest(self, exact, target):
        """The coarsest setting with which the result is accurate enough, with the result's deviation and the calls."""
        for setting in self.settings:
            try:
                _, calls, pressures = self.run(setting)
            except (subprocess.CalledProcessError, RuntimeError):
                continue
            deviation = float(numpy.max(numpy.abs(pressures / exact - 1)))
            if deviation <= target:
                return setting, deviation, calls
        return None


def of_example(program, what, case, folder):
    def run(setting):
        out = folder / "pressures"
        seconds, said = repeated(program, what, case, repr(setting), REPEATS[what], str(out))
        return seconds, int(said.get("calls", 0)), numpy.fromfile(out, dtype="<f8").reshape(-1, 4)

    return run


def of_scipy(method, model, case):
    def run(tolerance):
        strut = Strut(model, case)
        begun = time.process_time()
        done = solve_ivp(
            strut.slope, (0.0, TIMES[-1]), strut.start(), method, t_eval=TIMES, rtol=tolerance, atol=tolerance, first_step=1e-6
        )
        seconds = time.process_time() - begun
        if not done.success:
            raise RuntimeError(done.message)
        return seconds, strut.calls, strut.pressures(done.y)

    return run


def table(titles, rows):
    lines = ["| " + " | ".join(titles) + " |", "|" + "---|" * len(titles)]
    print("\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n")


def digits(value):
    return f"{value:.3g}" if value < 1000 else f"{value:,.0f}"


def strut(program, rounds, folder):
    """All solvers on all cases; whether each reached what was asked."""
    model = tomllib.loads(subprocess.run([program, "model"], capture_output=True, text=True, check=True).stdout)
    reached = True
    for case, name in enumerate(CASES):
        call(program, "exact", case, "-", 1, folder / "exact")
        exact = numpy.fromfile(folder / "exact", dtype="<f8").reshape(-1, 4)
        solvers = [
            Solver("oleo", STEPS, of_example(program, "oleo", case, folder)),
            Solver("diffsol BDF (Rust)", TOLERANCES, of_example(program, "bdf", case, folder)),
            *(Solver(f"SciPy {method}", TOLERANCES, of_scipy(method, model, case)) for method in ["Radau", "BDF", "LSODA"]),
        ]
        # Both right-hand sides must be one: SciPy's most accurate solution against diffsol's.
        deviation = float(numpy.max(numpy.abs(solvers[2].run(1e-9)[2] / exact - 1)))
        print(f"### {name}\n\nRight-hand side in Python against the one in Rust: largest relative deviation {deviation:.1e}.\n")
        if deviation > 1e-6:
            print("FAILED: the right-hand sides are not the same\n")
            reached = False
        rust_s, motion_s = (
            statistics.median(repeated(program, what, case, "-", 1, "-")[0] / CALLS for _ in range(rounds))
            for what in ["right-hand-side", "motion"]
        )
        python = Strut(model, case)
        begun = time.process_time()
        for k in range(20000):
            python.slope(3.0 * k / 20000, python.start())
        python_s = (time.process_time() - begun) / 20000
        print(
            f"One call of the right-hand side: {1e9 * rust_s:.0f} ns in Rust, {1e6 * python_s:.1f} us in Python; of the former the sines of "
            f"the motion {1e9 * motion_s:.0f} ns, which ours needs once a step.\n"
        )
        for target in TARGETS:
            found = [(solver, solver.coarsest(exact, target)) for solver in solvers]
            seconds = {solver.name: [] for solver in solvers}
            for _ in range(rounds):
                for solver, setting in found:
                    if setting:
                        seconds[solver.name].append(solver.run(setting[0])[0])
            own = statistics.median(seconds["oleo"]) if seconds["oleo"] else math.nan
            rows = []
            for solver, setting in found:
                if not setting:
                    rows.append([solver.name, "-", "not reached", "-", "-", "-", "-"])
                    reached = False
                    continue
                at, deviation, calls = setting
                median = statistics.median(seconds[solver.name])
                rows.append([
                    solver.name,
                    f"{1e3 * INTERVAL_S / at:.3g} ms" if solver.name == "oleo" else f"{at:.1e}",
                    f"{deviation:.1e}",
                    f"{1e3 * median:.3g}",
                    digits(median / own),
                    f"{calls:,}" if calls else "-",
                    digits(calls * rust_s / own) if calls else "-",
                ])
            print(f"Deviation of at most {target:.0e}, medians of {rounds} rounds:\n")
            table(
                ["solver", "step or tolerance", "largest deviation", "time, ms", "over ours", "right-hand sides", "their time in Rust over ours"],
                rows,
            )
    return reached


# The manoeuvre of the vehicles.
SPEED_M_S = 60 / 3.6
TICK_S = 0.005
# Deviation of the yaw rate over its peak. Solutions of CommonRoad's model at tolerances of 1e-6 and 1e-7 still differ by 2e-3.
YAW_TARGET = 5e-3
STEER_RAD, STEER_AT_S, DURATION_S, STEER_RATE_RAD_S = 0.03, 1.0, 10.0, 0.4


def common_road(tolerance, longest_s=math.inf):
    """The multi-body model with the parameters of its second vehicle (BMW 320i): seconds, calls, yaw rate over time."""
    from vehiclemodels.init_mb import init_mb
    from vehiclemodels.parameters_vehicle2 import parameters_vehicle2
    from vehiclemodels.vehicle_dynamics_mb import vehicle_dynamics_mb

    parameters = parameters_vehicle2()
    start = init_mb([0.0, 0.0, 0.0, SPEED_M_S, 0.0, 0.0, 0.0], parameters)
    calls = 0

    # The steering kinks twice: the solver begins anew there.
    kinks = [0.0, STEER_AT_S, STEER_AT_S + STEER_RAD / STEER_RATE_RAD_S, DURATION_S]
    yaw_rate = []
    begun = time.process_time()
    for k, (begin, end) in enumerate(zip(kinks, kinks[1:])):
        inputs = [STEER_RATE_RAD_S if k == 1 else 0.0, 0.0]

        def slope(_t, x):
            nonlocal calls
            calls += 1
            return vehicle_dynamics_mb(x, inputs, parameters)

        times = numpy.arange(begin, end, 0.01)
        done = solve_ivp(slope, (begin, end), start, "LSODA", t_eval=[*times, end], rtol=tolerance, atol=tolerance, max_step=longest_s)
        if not done.success:
            raise RuntimeError(done.message)
        start = done.y[:, -1]
        yaw_rate.extend(done.y[5])
    seconds = time.process_time() - begun
    return seconds, calls, numpy.array(yaw_rate)


def call_vehicle(program, springs, manoeuvre, repeats=10):
    """Processor time of one drive."""
    words = [springs, *manoeuvre]
    return (call(program, *words, repeats + 1)[0] - call(program, *words, 1)[0]) / repeats


def vehicle(program, rounds):
    exact = common_road(1e-10)[2]
    peak = float(numpy.max(numpy.abs(exact)))
    setting = deviation = None
    for tolerance in TOLERANCES:
        deviation = float(numpy.max(numpy.abs(common_road(tolerance)[2] - exact))) / peak
        if deviation <= YAW_TARGET:
            setting = tolerance
            break
    if setting is None:
        print(f"FAILED: CommonRoad's model reached no deviation of {YAW_TARGET}\n")
        return False
    manoeuvre = [SPEED_M_S, STEER_RAD, STEER_AT_S, DURATION_S]
    seconds = {"coil springs": [], "struts": [], "CommonRoad": [], "CommonRoad in ticks": []}
    calls = calls_in_ticks = 0
    for _ in range(rounds):
        for springs in ["coil springs", "struts"]:
            seconds[springs].append(call_vehicle(program, springs, manoeuvre))
        spent, calls, _ = common_road(setting)
        seconds["CommonRoad"].append(spent)
        spent, calls_in_ticks, _ = common_road(setting, TICK_S)
        seconds["CommonRoad in ticks"].append(spent)
    medians = {name: statistics.median(values) for name, values in seconds.items()}
    own = medians["struts"]

    def row(name, what, spent, more):
        return [name, what, f"{1e3 * spent:.3g}", f"{DURATION_S / spent:,.0f} x", f"{spent / own:,.2f}", more]

    print(f"### Vehicle: step of steer of {STEER_RAD} rad at 60 km/h on a flat road, {DURATION_S:.0f} s, medians of {rounds} rounds\n")
    table(
        ["model", "what it has", "time, ms", "real time", "over ours with struts", "right-hand sides"],
        [
            row("oleo, four struts", "14 degrees of freedom, Magic Formula, hydropneumatic struts", own, "-"),
            row("oleo, coil springs", "the same on the springs and dampers as sold", medians["coil springs"], "-"),
            row(
                "CommonRoad multi-body (Python, LSODA)",
                f"29 states, Magic Formula, linear springs; tolerance {setting:.1e}, yaw rate within {deviation:.1e} of its peak",
                medians["CommonRoad"],
                f"{calls:,}",
            ),
            row(
                "the same, no step beyond 5 ms",
                "as a controller that acts in every tick, or a rough road, asks for",
                medians["CommonRoad in ticks"],
                f"{calls_in_ticks:,}",
            ),
        ],
    )
    each_us = 1e6 * medians["CommonRoad"] / calls
    print(f"A call of CommonRoad's right-hand side takes at most {each_us:.0f} us in Python, its solver included.\n")
    return True


def main():
    reader = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    reader.add_argument("strut")
    reader.add_argument("vehicle")
    reader.add_argument("--rounds", type=int, default=5)
    given = reader.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        same = strut(given.strut, given.rounds, pathlib.Path(folder))
    same = vehicle(given.vehicle, given.rounds) and same
    sys.exit(0 if same else 1)


if __name__ == "__main__":
    main()
