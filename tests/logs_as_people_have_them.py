#!/usr/bin/env python3
"""Logs that other programs write, read by `oleo`: the same drive as candump, Vector ASC and BLF and MDF 4, and in another CAN database.

    logs_as_people_have_them.py OLEO FOLDER

OLEO is the binary, FOLDER an empty folder. Needs python-can, asammdf, cantools and pyarrow. The last line is `N passed, N failed`; the exit
status is 1 if anything failed, 2 if a package is missing.
"""

import csv
import json
import math
import pathlib
import random
import re
import subprocess
import sys

try:
    import asammdf
    import can
    import cantools
    import numpy
    import pyarrow.parquet
except ImportError as error:
    print(f"logs_as_people_have_them.py: {error}: pip install python-can asammdf cantools pyarrow", file=sys.stderr)
    sys.exit(2)

import unsorted_mf4

ROOT = pathlib.Path(__file__).resolve().parent.parent
CORNERS = ["front_left", "front_right", "rear_left", "rear_right"]
SHORT = ["FL", "FR", "RL", "RR"]

passed = failed = 0


def check(what, good, detail=""):
    global passed, failed
    if good:
        passed += 1
    else:
        failed += 1
        print(f"FAILED: {what} {detail}")


def oleo(*arguments):
    run = subprocess.run([OLEO, *map(str, arguments)], cwd=FOLDER, capture_output=True, text=True, check=False)
    check(f"oleo {' '.join(map(str, arguments))}", run.returncode == 0, run.stderr.strip())
    return run


def columns(log, *options):
    """The columns of a log as text, and as numbers."""
    name = f"{log}{'.map' if options else ''}.csv"
    oleo("convert", log, name, *options)
    text = (FOLDER / name).read_text()
    rows = csv.reader(text.splitlines())
    names = next(rows)
    values = numpy.array([[float(value) for value in row] for row in rows])
    return text, {name: values[:, k] for k, name in enumerate(names)}


def write(messages, name, **options):
    with can.Logger(FOLDER / name, **options) as logger:
        for message in messages:
            logger(message)


def drive():
    """A drive of the closed loop, and the model files that it drove with; rear left has a charge that its file does not know."""
    oleo("hil", "--scenario", "belgian", "--duration-s", "15", "--record", "all", "--out", "drive")
    (FOLDER / "drive.log").write_bytes((FOLDER / "drive/candump.log").read_bytes())
    index = ['[specimen]\nname = "car"\nkind = "vehicle"\n[strut]\n']
    for corner in CORNERS:
        name = corner.replace("_", "-")
        text = (FOLDER / "drive" / name / "model.toml").read_text()
        if corner == "rear_left":
            volumes = list(re.finditer(r"static_gas_volume_m3 = (\S+)", text))
            number = volumes[1].group(1)
            text = text[: volumes[1].start(1)] + str(float(number) / 1.1) + text[volumes[1].end(1) :]
        (FOLDER / f"{name}.toml").write_text(text)
        index.append(f'{corner} = "{name}.toml"\n')
    (FOLDER / "model.toml").write_text("".join(index))
    return list(can.LogReader(FOLDER / "drive.log"))


def own_database(messages):
    """The same frames in every format give the same bytes of columns."""
    write(messages, "own.asc")
    write(messages, "own.blf")
    write(messages, "plain.blf", compression_level=0, max_container_size=5000)
    for level in (0, 1, 2):
        write(messages, f"own{level}.mf4", compression_level=level)
    # What a logger adds: frames of others, remote frames, error frames.
    more = []
    for k, message in enumerate(messages):
        more.append(message)
        at = message.timestamp
        if k % 5 == 0:
            more.append(can.Message(timestamp=at, arbitration_id=0x18DB33F1, is_extended_id=True, data=[k % 256] * 3))
        if k % 50 == 0:
            more.append(can.Message(timestamp=at, arbitration_id=0x110, is_extended_id=False, is_remote_frame=True, dlc=8))
            more.append(can.Message(timestamp=at, is_error_frame=True))
            more.append(can.Message(timestamp=at, arbitration_id=0x111, is_extended_id=False, is_fd=True, data=bytes(range(48))))
    write(more, "strangers.asc")
    write(more, "strangers.blf")
    write(more, "strangers.mf4")
    unsorted_mf4.write([message for message in more if not message.is_remote_frame], FOLDER / "unsorted.mf4")
    mdf = asammdf.MDF(FOLDER / "own0.mf4")
    mdf.configure(write_fragment_size=4096)
    mdf.save(FOLDER / "fragments.mf4", compression=1, overwrite=True)
    expected, numbers = columns("drive.log")
    check("a row every 5 ms for 15 s", abs(len(numbers["time_s"]) - 3000) <= 1, str(len(numbers["time_s"])))
    others = ["own.asc", "own.blf", "plain.blf", "own0.mf4", "own1.mf4", "own2.mf4", "fragments.mf4"]
    for name in [*others, "strangers.asc", "strangers.blf", "strangers.mf4", "unsorted.mf4"]:
        check(f"{name}: the same columns, bit for bit", columns(name)[0] == expected)
    return numbers


def frames_through(messages):
    """Frames that went through `oleo convert` are those that python-can wrote."""

    def key(message):
        kind = (message.is_fd, message.is_remote_frame, message.bitrate_switch if message.is_fd else False)
        return (message.arbitration_id, message.is_extended_id, kind, bytes(message.data))

    random.seed(7)
    mixed = []
    for k in range(4000):
        extended, fd = k % 3 == 0, k % 4 == 1
        length = random.choice([0, 1, 7, 8, 12, 24, 64]) if fd else random.randint(0, 8)
        mixed.append(
            can.Message(
                timestamp=1_795_000_000 + 0.0007 * k,
                arbitration_id=random.randrange(1 << (29 if extended else 11)),
                is_extended_id=extended,
                is_fd=fd,
                bitrate_switch=fd and k % 8 == 1,
                data=random.randbytes(length),
                channel=k % 2,
            )
        )
    unsorted_mf4.write(mixed, FOLDER / "unsorted-mixed.mf4")
    read = list(can.LogReader(FOLDER / "unsorted-mixed.mf4"))
    check("unsorted MDF 4 is one, says asammdf", [key(message) for message in read] == [key(message) for message in mixed])
    ways = [
        ("unsorted-mixed.mf4", "f.log"),
        ("mixed.log", "a.asc"),
        ("mixed.asc", "b.log"),
        ("mixed.mf4", "c.log"),
        ("mixed.mf4", "d.asc"),
        ("a.asc", "e.log"),
        ("mixed.log", "g.mf4"),
        ("mixed.mf4", "h.mf4"),
        ("g.mf4", "i.log"),
        ("h.mf4", "j.asc"),
        ("mixed.blf", "k.log"),
        ("mixed.blf", "l.blf"),
        ("mixed.log", "m.blf"),
        ("m.blf", "n.asc"),
        ("l.blf", "o.mf4"),
    ]
    for source, target in ways:
        if source.startswith("mixed"):
            write(mixed, source)
        oleo("convert", source, target)
        read = list(can.LogReader(FOLDER / target))
        # python-can takes a CAN FD frame without data in ASC for a remote frame.
        same = [key(a) == key(b) or (a.is_fd and not a.data) for a, b in zip(mixed, read, strict=False)]
        check(f"{source} to {target}: the same frames", len(read) == len(mixed) and all(same), f"{len(read)} {sum(same)}")
        late = [abs((b.timestamp - read[0].timestamp) - (a.timestamp - mixed[0].timestamp)) for a, b in zip(mixed, read, strict=False)]
        check(f"{source} to {target}: the same times", max(late) < 2e-6, str(max(late)))


def written_blf(messages):
    """BLF that `oleo` writes says what python-can looks for in its head; what is no frame in one of python-can is counted."""
    oleo("convert", "drive.log", "written.blf")
    with can.BLFReader(FOLDER / "written.blf") as log:
        sizes = (log.file_size, log.object_count)
        begun, ended = log.start_timestamp, log.stop_timestamp
    expected = ((FOLDER / "written.blf").stat().st_size, len(messages))
    check("written.blf: sizes in the head", sizes == expected, f"{sizes} {expected}")
    times = (messages[0].timestamp, messages[-1].timestamp)
    check("written.blf: dates in the head", abs(begun - times[0]) < 1e-3 and abs(ended - times[1]) < 1e-3, f"{begun} {ended} {times}")
    first = next(iter(can.LogReader(FOLDER / "written.blf")))
    check("written.blf: begins with the log", abs(first.timestamp - times[0]) < 2e-6, str(first.timestamp))
    errors = sum(message.is_error_frame for message in can.LogReader(FOLDER / "strangers.blf"))
    said = oleo("convert", "strangers.blf", "strangers.log").stdout
    check("strangers.blf: error frames are counted", errors > 100 and f" {errors} error frames, 0 unreadable" in said, said)
    # As a logger leaves it that lost its supply.
    whole = (FOLDER / "own.blf").read_bytes()
    (FOLDER / "cut.blf").write_bytes(whole[: len(whole) // 2])
    run = subprocess.run([OLEO, "convert", "cut.blf", "cut.log"], cwd=FOLDER, capture_output=True, text=True, check=False)
    advice = re.search(r"after (\d+) whole frames; .*`head -c (\d+) IN.blf", run.stderr)
    check("cut.blf: one line", run.returncode == 2 and len(run.stderr.splitlines()) == 1 and advice is not None, run.stderr)
    (FOLDER / "kept.blf").write_bytes(whole[: int(advice.group(2))])
    kept = oleo("convert", "kept.blf", "kept.log").stdout
    check("kept.blf: the frames that were whole", kept.startswith(f"{advice.group(1)} frames of "), kept)


def written_mf4(messages):
    """MDF 4 that `oleo` writes is a bus log to asammdf: with our database it extracts the signals that cantools decodes."""
    oleo("convert", "drive.log", "written.mf4")
    check("written.mf4: the same columns, bit for bit", columns("written.mf4")[0] == (FOLDER / "drive.log.csv").read_text())
    database = cantools.database.load_file(ROOT / "controller/oleo.dbc")
    expected = {}
    for message in messages:
        definition = database.get_message_by_frame_id(message.arbitration_id)
        signals = definition.decode(message.data, decode_choices=False)
        expected.setdefault(definition.name, []).append((message.timestamp - messages[0].timestamp, signals))
    with asammdf.MDF(FOLDER / "written.mf4") as log:
        begun = log.header.start_time.timestamp()
        check("written.mf4: begins with the log", abs(begun - messages[0].timestamp) < 2e-6, str(begun))
        check("written.mf4: frames of a CAN bus", list(log.bus_logging_map["CAN"]) == [1], str(log.bus_logging_map))
        extracted = log.extract_bus_logging({"CAN": [(ROOT / "controller/oleo.dbc", 0)]}, ignore_value2text_conversion=True)
        compared = 0
        for name, readings in expected.items():
            times = numpy.array([time for time, _ in readings])
            for signal in readings[0][1]:
                where = [(group, index) for group, index in extracted.whereis(signal) if f" {name} 0x" in extracted.groups[group].channel_group.comment]
                found = extracted.get(signal, *where[0], ignore_invalidation_bits=True) if where else None
                if found is not None and found.samples.dtype.kind == "S":  # the text of a number
                    found = extracted.get(signal, *where[0], ignore_invalidation_bits=True, raw=True)
                values = numpy.array([signals[signal] for _, signals in readings], dtype=float)
                good = found is not None and len(found.samples) == len(values)
                good = good and numpy.allclose(found.samples.astype(float), values, rtol=1e-12, atol=0)
                good = good and numpy.max(numpy.abs(found.timestamps - times)) < 2e-6
                check(f"written.mf4: {name}.{signal} by asammdf as by cantools", good, str(where))
                compared += len(values)
        print(f"{compared} values of {sum(len(readings[0][1]) for readings in expected.values())} signals extracted by asammdf from our MDF 4")
    # One record follows the other in a group, and no block is larger than the standard recommends.
    blocks = re.findall(rb"##DZ.{20}DT(.).{5}(.{8})", (FOLDER / "written.mf4").read_bytes(), re.DOTALL)
    check("written.mf4: deflated, transposed blocks", len(blocks) >= 1 and all(kind == b"\x01" for kind, _ in blocks), str(len(blocks)))


def columns_for_data_frames():
    """Parquet has the columns of the CSV file, with its numbers."""
    oleo("convert", "drive.log", "drive.csv")
    oleo("convert", "drive.log", "drive.parquet")
    table = pyarrow.parquet.read_table(FOLDER / "drive.parquet")
    with open(FOLDER / "drive.csv", newline="") as file:
        titles, *rows = csv.reader(file)
    check("drive.parquet: the same columns", table.column_names == titles, str(table.column_names))
    for title, texts in zip(titles, zip(*rows)):
        expected = numpy.array([float(text) if text else numpy.nan for text in texts])
        check(f"drive.parquet: {title}", numpy.array_equal(table[title].to_numpy(), expected, equal_nan=True))


def map_of(signal, displacement, pressure, valve):
    lines = []
    for k, corner in enumerate(CORNERS):
        lines.append(f"[{corner}]")
        lines.append(f'displacement_m = {{ signal = "{signal(k, "x")}"{displacement} }}')
        lines += [f'p{p}_Pa = {{ signal = "{signal(k, f"P{p}")}"{pressure} }}' for p in range(1, 5)]
        lines += [f'valve{v} = {{ signal = "{signal(k, f"V{v}")}"{valve} }}' for v in range(1, 4)]
    return "\n".join(lines) + "\n"


def own_database_by_map(expected):
    """Our own database read as a foreign one gives the same values, to the single precision in which our controller reads."""
    side, axle, place = ["Left", "Right", "Left", "Right"], ["FRONT", "FRONT", "REAR", "REAR"], ["FrontLeft", "FrontRight", "RearLeft", "RearRight"]

    def signal(k, what):
        if what == "x":
            return f"DISPLACEMENT_{axle[k]}.Displacement{side[k]}"
        if what[0] == "P":
            return f"PRESSURE_{axle[k]}_{side[k].upper()}.{what}"
        return f"COMMAND.Valve{what[1]}_{place[k]}"

    (FOLDER / "own.toml").write_text(map_of(signal, "", "", ""))
    for name in ["drive.log", "own.asc", "own.blf", "own2.mf4"]:
        _, found = columns(name, "--dbc", ROOT / "controller/oleo.dbc", "--signals", "own.toml")
        for column, values in expected.items():
            there = found[column][: len(values)]
            same = numpy.allclose(there, values, rtol=1e-6, atol=1e-9, equal_nan=True)
            check(f"{name} by map: {column}", len(found[column]) == len(values) and same, str(numpy.nanmax(numpy.abs(there - values))))


DBC = """VERSION ""
NS_ :
BS_:
BU_: Car
BO_ 2566848768 HEIGHTS: 8 Car
{heights}
{pressures}
BO_ 544 VALVES: 2 Car
{valves}
{floats}
"""


def another_database(expected):
    """The drive in an invented database: big-endian heights that fall in compression, absolute bar, a multiplexed message of four
    floating-point numbers, CAN FD."""
    heights = "\n".join(f' SG_ {s}_x : {7 + 16 * k}|16@0+ (0.01,0) [0|0] "mm" Vector__XXX' for k, s in enumerate(SHORT))
    pressures = ["BO_ 528 PRESSURES: 20 Car", ' SG_ Corner M : 0|8@1+ (1,0) [0|3] "" Vector__XXX']
    floats = []
    for k, s in enumerate(SHORT):
        for p in range(1, 5):
            pressures.append(f' SG_ {s}_P{p} m{k} : {8 + 32 * (p - 1)}|32@1- (1,0) [0|0] "bar" Vector__XXX')
            floats.append(f"SIG_VALTYPE_ 528 {s}_P{p} : 1;")
    valves = "\n".join(f' SG_ {s}_V{v} : {3 * k + v - 1}|1@1+ (1,0) [0|1] "" Vector__XXX' for k, s in enumerate(SHORT) for v in (1, 2, 3))
    (FOLDER / "car.dbc").write_text(DBC.format(heights=heights, pressures="\n".join(pressures), valves=valves, floats="\n".join(floats)))
    (FOLDER / "car.toml").write_text(map_of(lambda k, what: f"{SHORT[k]}_{what}", ", zero = 312.0, sign = -1", ", zero = 1.01325", ", open = 0"))
    database = cantools.database.load_file(FOLDER / "car.dbc")
    messages = []
    for row in range(len(expected["time_s"])):
        at = 100 + 0.005 * row
        if math.isnan(expected["valve1_front_left"][row]):
            continue
        for k in range(4):
            content = {f"{SHORT[k]}_P{p}": expected[f"p{p}_{CORNERS[k]}_Pa"][row] * 1e-5 + 1.01325 for p in range(1, 5)}
            data = database.encode_message("PRESSURES", {"Corner": k, **content})
            messages.append(can.Message(timestamp=at + 1e-4 * k, arbitration_id=528, is_extended_id=False, is_fd=True, data=data))
        content = {f"{s}_x": 312 - 1e3 * expected[f"displacement_{c}_m"][row] for s, c in zip(SHORT, CORNERS, strict=True)}
        data = database.encode_message("HEIGHTS", content)
        messages.append(can.Message(timestamp=at + 0.0012, arbitration_id=2566848768 & 0x1FFFFFFF, is_extended_id=True, data=data))
        content = {f"{s}_V{v}": 1 - int(expected[f"valve{v}_{c}"][row]) for s, c in zip(SHORT, CORNERS, strict=True) for v in (1, 2, 3)}
        data = database.encode_message("VALVES", content)
        messages.append(can.Message(timestamp=at + 0.002, arbitration_id=544, is_extended_id=False, data=data))
    texts = []
    for name in ["car.log", "car.asc", "car.blf", "car.mf4"]:
        write(messages, name)
        text, found = columns(name, "--dbc", "car.dbc", "--signals", "car.toml")
        texts.append(text)
        known = ~numpy.isnan(expected["valve1_front_left"])
        for column, values in expected.items():
            if column in ("time_s", "drive"):
                continue
            # Half a step of the bus; half a unit of single precision in bar.
            step = 5.01e-6 if column.endswith("_m") else 0
            values, relative = values[known], 6.1e-8 if column.endswith("_Pa") else 0
            off = numpy.abs(found[column][: len(values)] - values) - relative * (numpy.abs(values) + 101325)
            good = len(values) == len(found[column]) and numpy.max(off) <= step
            check(f"{name} in another database: {column}", good, str(numpy.max(off)))
    check("another database: the same columns of all formats, bit for bit", len(set(texts)) == 1)


def diagnosed(log, *options):
    oleo("diagnose", log, "--vehicle", "model.toml", "--out", f"found-{log}", *options)
    report = json.loads((FOLDER / f"found-{log}/report.json").read_text())
    for key in ("runtime_s", "inputs", "notes", "command"):
        report.pop(key, None)
    # A recording is called as its log.
    return json.loads(re.sub(rf"\b{log.split('.')[0]}\b", "LOG", json.dumps(report)))


def units_mistaken():
    """A map that takes a signal for one in another unit is refused in one line."""
    for right, wrong, told in [("zero = 1.01325", 'zero = 1.01325, unit = "Pa"', "in bar"), ("zero = 312.0", 'zero = 312.0, unit = "m"', "in mm")]:
        (FOLDER / "mistaken.toml").write_text((FOLDER / "car.toml").read_text().replace(right, wrong))
        command = [OLEO, "diagnose", "car.mf4", "--vehicle", "model.toml", "--dbc", "car.dbc", "--signals", "mistaken.toml", "--no-out"]
        run = subprocess.run(command, cwd=FOLDER, capture_output=True, text=True, check=False)
        good = run.returncode == 2 and told in run.stderr and "front-left strut" in run.stderr and run.stderr.count("\n") == 1
        check(f"units mistaken: {wrong}", good, run.stderr.strip())


def diagnoses():
    """Every format gives the same diagnosis, number for number, and that in another database the same effect."""
    expected = diagnosed("drive.log")
    found = [(effect["id"], effect["place"]) for effect in expected["effects"]]
    check("the altered strut is named", found == [("gas_charge_error", "rear-left/accumulator-2")], str(found))
    check("own.asc: the same diagnosis", diagnosed("own.asc") == expected)
    check("own.blf: the same diagnosis", diagnosed("own.blf") == expected)
    check("own2.mf4: the same diagnosis", diagnosed("own2.mf4") == expected)
    other = diagnosed("car.mf4", "--dbc", "car.dbc", "--signals", "car.toml")
    found = [(effect["id"], effect["place"]) for effect in other["effects"]]
    check("another database: the altered strut is named", found == [("gas_charge_error", "rear-left/accumulator-2")], str(found))
    size = [report["effects"][0]["parameters"]["relative_error_2"]["value"] for report in (expected, other) if report["effects"]]
    check("another database: of the same size", len(size) == 2 and abs(size[0] - size[1]) < 0.005, str(size))
    print(f"relative error of the gas charge: {size}, 0.1 was concealed")


OLEO, FOLDER = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
logged = drive()
drive_columns = own_database(logged)
frames_through(logged)
written_blf(logged)
written_mf4(logged)
columns_for_data_frames()
own_database_by_map(drive_columns)
another_database(drive_columns)
units_mistaken()
if "--no-diagnosis" not in sys.argv:
    diagnoses()
print(f"{passed} passed, {failed} failed")
sys.exit(1 if failed else 0)
