#!/usr/bin/env python3
"""Shows that `oleo convert` needs no more memory for a long log than for a short one, and how long python-can and cantools take for the same.

    streaming.py OLEO FOLDER [--millions 2,20] [--frames 300000] [--rounds 3] [--columns]

OLEO is the binary, FOLDER an empty folder on a disk with room (6 GB; for more than 100 million frames 25 MB a million). Needs numpy, python-can and cantools. A drive of
the closed loop is repeated over and over and goes as text of candump through a pipe into `oleo convert`, as many million frames as --millions says (2 fill a group of Parquet): to
BLF, and that BLF to MDF 4 and to columns as Parquet; up to 20 million also to ASC and back to candump, and to columns as CSV, as MCAP and by a map of our own
database as a foreign one. Measured are the peak memory of the process and its processor time. --columns leaves all but columns out.
Then one log of --frames frames is converted by `oleo` and by python-can in turns, and decoded by `oleo` and by cantools with the same database.
Printed are tables in Markdown. The exit status is 1 if frames are lost or the largest log takes 12 MB more memory than the smallest, 2 if a package is missing.
"""

import argparse
import pathlib
import re
import statistics
import subprocess
import sys
import time

try:
    import can
    import cantools
    import numpy
except ImportError as error:
    print(f"streaming.py: {error}: pip install python-can cantools numpy", file=sys.stderr)
    sys.exit(2)

ROOT = pathlib.Path(__file__).resolve().parent.parent
# Ticks after which all counters of the messages have run round, so that the drive can be repeated.
TICKS, TICK_US = 1024, 5000
BEGIN_US = 1_795_000_000_000_000
# Where the digits of a time are: (1795000000.000000)
DIGITS = [*range(1, 11), *range(12, 18)]
# 45 kB for each of the 190 groups of Parquet that 200 million frames make; all else stays the same.
MORE_MEMORY_KB = 12 << 10
# Frames that are written as text, which has 65 bytes for each.
MOST_AS_TEXT = 20_000_000

# A process counts the memory of the one that it was forked from as its own, so it is started by a small one. That takes 10 MB, less than any of ours.
WATCH = """
import os, sys
_, status, used = os.wait4(os.posix_spawnp(sys.argv[1], sys.argv[1:], os.environ), 0)
print(used.ru_maxrss, used.ru_utime + used.ru_stime, file=sys.stderr)
sys.exit(os.waitstatus_to_exitcode(status))
"""
CONVERT = """
import sys, can
with can.LogReader(sys.argv[1]) as log, can.Logger(sys.argv[2]) as out:
    for message in log:
        out(message)
"""
# cantools gives the values and keeps nothing, so that what it is charged for is decoding only.
DECODE = """
import sys, can, cantools
database = cantools.database.load_file(sys.argv[2])
with can.LogReader(sys.argv[1]) as log:
    for message in log:
        database.decode_message(message.arbitration_id, message.data, decode_choices=False)
"""


def measured(command, source=None):
    """Output, peak memory (kB), processor time and wall-clock time (s) of a command into which `source` is piped."""
    watched = [sys.executable, "-I", "-S", "-c", WATCH, *map(str, command)]
    stdin = subprocess.PIPE if source else subprocess.DEVNULL
    begun = time.monotonic()
    with subprocess.Popen(watched, cwd=FOLDER, stdin=stdin, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as run:
        if source:
            try:
                for block in source:
                    run.stdin.write(block)
            except BrokenPipeError:
                pass
        said, complaint = (text.decode() for text in run.communicate())
    wall = time.monotonic() - begun
    if run.returncode != 0:
        sys.exit(f"streaming.py: {' '.join(map(str, command))}: {complaint.strip()}")
    peak, processor = complaint.splitlines()[-1].split()
    return said, int(peak), float(processor), wall


class Drive:
    """A drive as text of candump that can be repeated."""

    def __init__(self):
        seconds = TICKS * TICK_US / 1e6
        subprocess.run([OLEO, "hil", "--scenario", "belgian", "--duration-s", str(seconds), "--out", "drive"], cwd=FOLDER, check=True, capture_output=True)
        lines = (FOLDER / "drive/candump.log").read_bytes().splitlines(keepends=True)
        self.lengths = numpy.array([len(line) for line in lines])
        self.text = numpy.frombuffer(b"".join(lines), dtype=numpy.uint8).copy()
        begins = numpy.concatenate([[0], numpy.cumsum(self.lengths)[:-1]])
        self.places = begins[:, None] + numpy.array(DIGITS)[None, :]
        times = [re.match(rb"\((\d+)\.(\d+)\)", line).groups() for line in lines]
        self.times_us = numpy.array([int(seconds) * 1_000_000 + int(micros) for seconds, micros in times])

    def repeated(self, frames):
        """The text of so many frames, drive by drive."""
        powers = 10 ** numpy.arange(len(DIGITS) - 1, -1, -1)
        begin_us = BEGIN_US
        while frames > 0:
            times = self.times_us + begin_us
            self.text[self.places] = (times[:, None] // powers) % 10 + ord("0")
            count = min(frames, len(self.lengths))
            yield self.text[: int(self.lengths[:count].sum())].tobytes()
            frames -= count
            begin_us += TICKS * TICK_US


def signal_map():
    """A map that reads our own database as a foreign one."""
    text = []
    for corner in ("front_left", "front_right", "rear_left", "rear_right"):
        axle, side = corner.split("_")
        place, message = axle.title() + side.title(), f"PRESSURE_{axle.upper()}_{side.upper()}"
        text.append(f'[{corner}]\ndisplacement_m = {{ signal = "DISPLACEMENT_{axle.upper()}.Displacement{side.title()}" }}')
        text += [f'p{point}_Pa = {{ signal = "{message}.P{point}" }}' for point in range(1, 5)]
        text += [f'valve{valve} = {{ signal = "COMMAND.Valve{valve}_{place}" }}' for valve in range(1, 4)]
    (FOLDER / "map.toml").write_text("\n".join(text))


def ways(frames, columns_only):
    """What is converted: source, target, name and options. Columns have as many samples as the drive has ticks."""
    yield "/dev/stdin", "long.blf", "candump to BLF", []
    if not columns_only:
        yield "long.blf", "long.mf4", "BLF to MDF 4", []
    if frames <= MOST_AS_TEXT and not columns_only:
        yield "long.blf", "long.asc", "BLF to ASC", []
        yield "long.asc", "long.log", "ASC to candump", []
        yield "long.mf4", "long.log", "MDF 4 to candump", []
    yield "long.blf", "long.parquet", "BLF to Parquet", []
    if frames <= MOST_AS_TEXT:
        yield "long.blf", "long.csv", "BLF to CSV", []
        yield "long.blf", "long.mcap", "BLF to MCAP", []
        yield "long.blf", "long.csv", "BLF by DBC to CSV", ["--dbc", ROOT / "controller/oleo.dbc", "--signals", "map.toml"]


def is_whole(said, target, frames):
    """Whether `oleo convert` says that it used all frames."""
    if target.endswith((".csv", ".mcap", ".parquet")):
        # The log may end in the middle of a tick, so that a few frames of the last are missing, or come after its displacements.
        found = re.search(r" (\d+) lost, 0 repeated, 0 late, 0 corrupted, (\d+) out of sequence| (0) without a reading, 0 repeated, (\d+) outside", said)
        return said.startswith("1 drive") and found and all(int(number or 0) < 8 for number in found.groups()) and " 0 unreadable" in said
    return said.startswith(f"{frames} frames of ") and " 0 unreadable" in said


def memory(drive, millions, columns_only):
    print("| frames | conversion | peak memory | processor time a frame | frames a second | file |\n|---|---|---|---|---|---|")
    peaks, good = {}, True
    signal_map()
    for frames in [round(1e6 * number) for number in millions]:
        for source, target, name, options in ways(frames, columns_only):
            piped = drive.repeated(frames) if source == "/dev/stdin" else None
            said, peak, processor, wall = measured([OLEO, "convert", source, target, *options], piped)
            if not is_whole(said, target, frames):
                print(f"FAILED: {name}: {said.strip()}")
                good = False
            peaks.setdefault(name, []).append(peak)
            size = (FOLDER / target).stat().st_size
            row = f"{peak / 1024:.1f} MB | {1e6 * processor / frames:.2f} us | {frames / wall / 1e6:.2f} million | {size / 1e6:.0f} MB"
            print(f"| {frames / 1e6:g} million | {name} | {row} |", flush=True)
            if target.endswith((".csv", ".mcap", ".parquet")):
                (FOLDER / target).unlink()
        for path in FOLDER.glob("long.*"):
            path.unlink()
    for name, found in peaks.items():
        if found[-1] > found[0] + MORE_MEMORY_KB:
            print(f"FAILED: {name}: {found[0]} kB for the shortest log, {found[-1]} kB for the longest")
            good = False
    return good


def side_by_side(drive, frames, rounds):
    with open(FOLDER / "log.log", "wb") as log:
        log.writelines(drive.repeated(frames))
    database = ROOT / "controller/oleo.dbc"
    python = [sys.executable, "-c"]
    pairs = []
    for source, target in [("log.log", "ours.asc"), ("log.log", "ours.blf"), ("ours.blf", "ours.log"), ("ours.asc", "back.log"), ("log.log", "ours.mf4")]:
        name = " to ".join({"log": "candump", "asc": "ASC", "blf": "BLF", "mf4": "MDF 4"}[path[-3:]] for path in (source, target))
        theirs = [*python, CONVERT, source, target.replace("ours", "theirs").replace("back", "theirs-back")]
        pairs.append((name, "python-can", [OLEO, "convert", source, target], theirs))
    by_map = ["--dbc", database, "--signals", "map.toml"]
    ours = [OLEO, "convert", "log.log", "ours.csv", *by_map]
    pairs.append(("candump by DBC to columns", "python-can, cantools", ours, [*python, DECODE, "log.log", database]))
    times = {name: [] for name, *_ in pairs}
    for _ in range(rounds):
        for name, _, ours, theirs in pairs:
            times[name].append((measured(ours)[2], measured(theirs)[2]))
    print(f"\n{frames} frames, processor time with the start of the programs, medians of {rounds} rounds in turns; ratios round by round.\n")
    print("| conversion | oleo | the other | ratio |\n|---|---|---|---|")
    for name, other, *_ in pairs:
        ours, theirs = (statistics.median(column) for column in zip(*times[name], strict=True))
        ratios = [theirs / ours for ours, theirs in times[name]]
        print(f"| {name} | {ours:.2f} s | {theirs:.2f} s ({other}) | {statistics.median(ratios):.0f} ({min(ratios):.0f} to {max(ratios):.0f}) |")

    def frames_of(path):
        return [(message.arbitration_id, bytes(message.data)) for message in can.LogReader(FOLDER / path)]

    same = frames_of("ours.blf") == frames_of("theirs.blf") == frames_of("ours.log")
    if not same:
        print("FAILED: the two made different frames")
    return same


arguments = argparse.ArgumentParser()
arguments.add_argument("oleo", type=pathlib.Path)
arguments.add_argument("folder", type=pathlib.Path)
arguments.add_argument("--millions", default="2,20", type=lambda text: [float(number) for number in text.split(",")])
arguments.add_argument("--frames", default=300_000, type=int)
arguments.add_argument("--rounds", default=3, type=int)
arguments.add_argument("--columns", action="store_true")
options = arguments.parse_args()
OLEO, FOLDER = options.oleo.resolve(), options.folder.resolve()
repeated = Drive()
print(f"python-can {can.__version__}, cantools {cantools.__version__}, Python {sys.version.split()[0]}\n")
is_good = [memory(repeated, options.millions, options.columns)]
if not options.columns:
    is_good.append(side_by_side(repeated, options.frames, options.rounds))
sys.exit(0 if all(is_good) else 1)
