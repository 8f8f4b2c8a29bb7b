"""Prints the figures of docs/performance.md: instructions, operations and times of a strut's step, a campaign, the loop and the vehicle.

    performance.py RELEASE [CAMPAIGN]

RELEASE is a folder with oleo and, in examples/, strut_step, campaign and processor_limits. CAMPAIGN is a folder of recordings; without it
the rows of campaigns are left out. Instructions are those of callgrind (valgrind), which depend on nothing but the program; operations
are found by looking up each counted instruction in the disassembly. Processor time leaves out
the time in which other programs had the processor, and is the best of five.
"""

import collections
import os
import pathlib
import re
import subprocess
import sys
import tempfile

STEPS = 20000
TICK_S = 0.005
# Simulated time of the two runs whose difference counts, s.
RUNS_S = (2, 6)
# The same for the clock.
LONG_RUNS_S = (5, 65)


def output(*words):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, check=True).stdout


def callgrind(*words, options=()):
    """Instructions of a command."""
    command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", *options, *map(str, words)]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stderr
    return int(re.search(r"Collected : (\d+)", said)[1])


def disassembly(program):
    """Mnemonic and operands of the instruction at each address."""
    found = {}
    for line in output("objdump", "-d", "--no-show-raw-insn", program).splitlines():
        match = re.match(r"\s*([0-9a-f]+):\s+(\S+)\s*(.*)", line)
        if match:
            found[int(match[1], 16)] = (match[2], match[3].split("#")[0].strip())
    return found


PACKED = {"pd": 2, "sd": 1}
ARITHMETIC = {"add": "additions", "sub": "additions", "mul": "multiplications", "div": "divisions", "sqrt": "roots"}


def kinds(mnemonic, operands):
    """What an instruction is counted as, with how often."""
    match = re.fullmatch(r"v?(add|sub|mul|div|sqrt)(sd|pd)", mnemonic)
    if match:
        yield ARITHMETIC[match[1]], PACKED[match[2]]
    if mnemonic.startswith(("j", "call", "ret")):
        yield "branches", 1
    if "(" not in operands or mnemonic.startswith(("lea", "nop", "call", "j", "prefetch")):
        return
    # AT&T: the last operand is where the result goes.
    parts = re.findall(r"[^,(]*\([^)]*\)|[^,]+", operands)
    moves, compares = mnemonic.startswith("mov") or "mov" in mnemonic, mnemonic.startswith(("cmp", "test", "ucomi", "comi"))
    if "(" in parts[-1] and not compares:
        yield "stores", 1
        if not moves:
            yield "loads", 1
    else:
        yield "loads", 1


def operations(program, function, *words):
    """Instructions within a function and all that it calls, by kind."""
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder) / "callgrind"
        options = ["--dump-instr=yes", "--compress-strings=no", "--compress-pos=no", "--collect-atstart=no"]
        command = ["valgrind", "--tool=callgrind", f"--toggle-collect=*{function}*", f"--callgrind-out-file={out}", *options]
        subprocess.run([*command, program, *map(str, words)], capture_output=True, check=True)
        lines = out.read_text().splitlines()
    code, counted, here, is_call = disassembly(program), collections.Counter(), False, False
    for line in lines:
        if line.startswith("ob="):
            here = line == f"ob={program}"
        elif line.startswith("calls="):
            is_call = True
        elif line.startswith("0x"):
            # What follows "calls=" was spent in the callee, where it is counted.
            if not is_call:
                address, _, count = line.split()
                counted["instructions"] += int(count)
                for kind, times in kinds(*code[int(address, 16)]) if here else ():
                    counted[kind] += times * int(count)
            is_call = False
    return counted


def difference(command, runs):
    """Instructions for each unit of a command's last argument, without its start."""
    first, last = (callgrind(*command(run)) for run in runs)
    return (last - first) / (runs[1] - runs[0])


def processor_s(command):
    """Processor time of a command, s: the least of several, since disturbances make it longer only."""

    def once():
        process = subprocess.Popen([str(word) for word in command], stdout=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            sys.exit(f"{command} failed")
        return used.ru_utime

    return min(once() for _ in range(5))


def real_time(command):
    """Simulated time over processor time of a command whose last argument is the simulated time."""
    short, long = LONG_RUNS_S
    return (long - short) / (processor_s(command(long)) - processor_s(command(short)))


def limits(program):
    return {name: float(value.split()[0]) for name, value in (line.split(": ") for line in output(program).splitlines())}


def table(titles, rows):
    print("| " + " | ".join(titles) + " |\n" + "|" + "---|" * len(titles))
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print()


def main():
    release = pathlib.Path(sys.argv[1]).resolve()
    campaign = pathlib.Path(sys.argv[2]).resolve() if len(sys.argv) > 2 else None
    examples, oleo = release / "examples", release / "oleo"
    step = operations(examples / "strut_step", "advance_with_speeds", STEPS)
    each = {kind: count / STEPS for kind, count in step.items()}
    few, many = 10 * STEPS, 60 * STEPS
    step_ns = 1e9 * (processor_s([examples / "strut_step", many]) - processor_s([examples / "strut_step", few])) / (many - few)
    rows = [["strut's step of 1 ms, all terms of the preset", f"{each['instructions']:,.0f} a step", f"{step_ns:.0f} ns a step"]]
    if campaign and campaign.is_dir():
        for name, more in [("campaign (10 recordings, 368 s)", []), ("the same, every term of the vocabulary", ["--every-term"])]:
            counted = difference(lambda n, more=more: [examples / "campaign", campaign, *more, "--repeat", n], (1, 3))
            replay = [examples / "campaign", campaign, *more, "--repeat"]
            spent = (processor_s([*replay, 31]) - processor_s([*replay, 1])) / 30
            rows.append([name, f"{1e-6 * counted:,.1f} million", f"{1e3 * spent:.1f} ms"])
    drive = ["drive", "--manoeuvre", "belgian", "--model", "handling", "--setting", "soft", "--no-out", "--duration-s"]
    for name, words in [
        ("tick of the loop: `oleo hil`, ride model, one core", ["hil", "--no-out", "--threads", 1, "--duration-s"]),
        ("14 degrees of freedom on four struts, Belgian block, 5 ms: `oleo drive`", drive),
    ]:
        counted = difference(lambda s, words=words: [oleo, *words, s], RUNS_S) * TICK_S
        fast = real_time(lambda s, words=words: [oleo, *words, s])
        rows.append([name, f"{counted:,.0f} a tick", f"{fast:,.0f} x real time"])
    print("### Figures of this build\n")
    table(["work", "instructions", "processor time"], rows)

    at = limits(examples / "processor_limits")
    print("### Operations of a strut's step, and what they need at least\n")
    pairs = at["add or multiply throughput"]
    costs = [("additions", pairs), ("multiplications", pairs), ("divisions", at["divide throughput"]), ("roots", at["root throughput"])]
    least = [["additions and multiplications", f"{each['additions'] + each['multiplications']:,.0f}", f"{pairs:.3f}"]]
    least += [[kind, f"{each[kind]:.1f}", f"{cost:.2f}"] for kind, cost in costs[2:]]
    least += [[kind, f"{each[kind]:,.0f}", "-"] for kind in ("loads", "stores", "branches")]
    table(["operation", "done in a step", "ns each at full throughput, two at a time"], least)
    print(f"All arithmetic at full throughput: {sum(each[kind] * cost for kind, cost in costs):.0f} ns; the step takes {step_ns:.0f} ns.\n")
    print("Latencies, ns: " + ", ".join(f"{name.split()[0]} {value:.2f}" for name, value in at.items() if "latency" in name) + ".\n")


if __name__ == "__main__":
    main()
