#!/usr/bin/env python3
"""Runs as messages for viewers, read by programs that are not ours: MCAP files by the Python package mcap, live runs by websockets.

    messages.py OLEO FOLDER

OLEO is the binary, FOLDER an empty folder. Needs mcap, websockets and jsonschema. The last line is `N passed, N failed`; the exit status
is 1 if anything failed, 2 if a package is missing.
"""

import csv
import json
import math
import pathlib
import re
import struct
import subprocess
import sys

try:
    import jsonschema
    import mcap.reader
    import websockets.sync.client
except ImportError as error:
    print(f"messages.py: {error}: pip install mcap websockets jsonschema", file=sys.stderr)
    sys.exit(2)

CORNERS = ["front_left", "front_right", "rear_left", "rear_right"]
TICK_NS = 5_000_000

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


def rows(name):
    with open(FOLDER / name, newline="") as file:
        return list(csv.DictReader(file))


def place(column):
    """Topic without the run, and field, of a column."""
    for corner in CORNERS:
        if f"_{corner}" in column:
            return corner, column.replace(f"_{corner}", "", 1)
    controller = {"valve_word", "energised_word", "front_valves_open", "rear_valves_open", "handling", "rollover_guard", "mode", "fault"}
    return ("controller" if column in controller else "body"), column


def read(name, in_order=True):
    """The messages of a file by topic and time, once by its index and once as a stream, with every CRC checked. Those of a topic, and by the index all,
    are in the order of time, and all of them unless told otherwise."""
    ways = []
    for reader in (mcap.reader.SeekingReader, mcap.reader.NonSeekingReader):
        with open(FOLDER / name, "rb") as file:
            source = reader(file, validate_crcs=True)
            found, times, of_topic = {}, [], {}
            for schema, channel, message in source.iter_messages():
                if message.sequence == 0:
                    check(f"{name}: {channel.topic} has a JSON Schema", (schema.encoding, channel.message_encoding) == ("jsonschema", "json"))
                    jsonschema.Draft202012Validator.check_schema(json.loads(schema.data))
                    jsonschema.validate(json.loads(message.data), json.loads(schema.data))
                times.append(message.log_time)
                of_topic.setdefault(channel.topic, []).append(message.log_time)
                found.setdefault(channel.topic, {})[message.log_time] = json.loads(message.data)
            if in_order or reader is mcap.reader.SeekingReader:
                check(f"{name}: messages in the order of time", times == sorted(times))
            check(f"{name}: messages of each topic in the order of time", all(times == sorted(times) for times in of_topic.values()))
            if reader is mcap.reader.SeekingReader:
                count = sum(len(messages) for messages in found.values())
                check(f"{name}: the index counts its messages", source.get_summary().statistics.message_count == count, str(count))
            ways.append(found)
    check(f"{name}: the same messages by index and as a stream", ways[0] == ways[1])
    return ways[0]


def same_as_csv(what, messages, table, run="", time=lambda row: round(float(row["time_s"]) * 1e9)):
    """Every value of a table is in the messages, to the last bit, and what is missing in one is missing in the other."""
    different, compared = [], 0
    for row in table:
        for column, text in row.items():
            if column in ("time_s", "drive"):
                continue
            topic, field = place(column)
            found = messages.get(f"{run}/{topic}", {}).get(time(row), {}).get(field)
            if column in ("mode", "fault"):
                expected = text or None
            else:
                expected = None if math.isnan(float(text)) else float(text)
            compared += 1
            if found != expected:
                different.append((row["time_s"], column, expected, found))
    check(f"{what}: {compared} values as in the CSV file", compared > 1000 and not different, str(different[:3]))


def files():
    run = ["hil", "--scenario", "bus-silence"]
    oleo(*run, "--out", "run", "--mcap", "run.mcap")
    messages = read("run.mcap")
    topics = ["/body", *(f"/{corner}" for corner in CORNERS), "/controller", "/bus"]
    check("run.mcap: the topics", sorted(messages) == sorted(topics), str(sorted(messages)))
    table = rows("run/timeseries.csv")
    check("run.mcap: a message for each topic and tick", {len(found) for found in messages.values()} == {len(table)})
    same_as_csv("run.mcap", messages, table)
    signals = [[int(messages[f"/{corner}"][tick * TICK_NS][f"valve{v}"]) for corner in CORNERS for v in (1, 2, 3)] for tick in range(len(table))]
    words = [sum(bit << place for place, bit in enumerate(word)) for word in signals]
    check("run.mcap: the valves", words == [int(row["energised_word"]) for row in table])
    counted = sum(at["frames_sent"] + at["frames_received"] for at in messages["/bus"].values())
    logged = len((FOLDER / "run/candump.log").read_text().splitlines())
    check("run.mcap: the frames", counted == logged, f"{counted} {logged}")
    check("run.mcap: the controller's estimates", any(at.get("vertical_rms_m_s2", 0) > 0.1 for at in messages["/controller"].values()))
    oleo(*run, "--no-out", "--mcap", "again.mcap")
    check("the same bytes again", (FOLDER / "run.mcap").read_bytes() == (FOLDER / "again.mcap").read_bytes())
    oleo("drive", "--manoeuvre", "lane-change", "--setting", "soft,controlled", "--out", "lane", "--mcap", "lane.mcap")
    messages = read("lane.mcap")
    for setting in ("soft", "controlled"):
        same_as_csv(f"lane.mcap, {setting}", messages, rows(f"lane/{setting}.csv"), f"/{setting}")
    oleo("convert", "run/candump.log", "log.csv")
    oleo("convert", "run/candump.log", "log.mcap")
    same_as_csv("log.mcap", read("log.mcap"), rows("log.csv"))
    # The drives of a log are written one after the other, each from its own zero.
    (FOLDER / "two.log").write_bytes(2 * (FOLDER / "run/candump.log").read_bytes())
    oleo("convert", "two.log", "two.csv")
    oleo("convert", "two.log", "two.mcap")
    messages = read("two.mcap", in_order=False)
    for drive in "12":
        same_as_csv(f"two.mcap, drive {drive}", messages, [row for row in rows("two.csv") if row["drive"] == drive], f"/drive_{drive}")


def follow(address):
    """Subscribes to everything, and gives the topics and their messages by time until the server closes."""
    found = {}
    with websockets.sync.client.connect(address, subprotocols=["foxglove.websocket.v1"], max_size=None, compression=None) as viewer:
        info, offer = json.loads(viewer.recv()), json.loads(viewer.recv())
        check("live: serverInfo, then advertise", (info["op"], offer["op"]) == ("serverInfo", "advertise"))
        topics = {channel["id"] + 100: channel["topic"] for channel in offer["channels"]}
        for channel in offer["channels"]:
            jsonschema.Draft202012Validator.check_schema(json.loads(channel["schema"]))
        viewer.send(json.dumps({"op": "subscribe", "subscriptions": [{"id": k, "channelId": k - 100} for k in topics]}))
        for message in viewer:
            if message[0] == 1:
                subscription, time = struct.unpack_from("<IQ", message, 1)
                found.setdefault(topics[subscription], {})[time] = json.loads(message[13:])
    return found


def live():
    run = ["hil", "--scenario", "belgian", "--duration-s", "4"]
    oleo(*run, "--out", "alone")
    command = [OLEO, *run, "--live", "0", "--out", "followed"]
    with subprocess.Popen(command, cwd=FOLDER, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as served:
        said = served.stderr.readline()
        address = re.search(r"ws://127\.0\.0\.1:\d+", said).group()
        # One that connects and never reads.
        with websockets.sync.client.connect(address, subprotocols=["foxglove.sdk.v1"], compression=None):
            messages = follow(address)
        said = served.stderr.read()
    check("live: the run succeeds", served.returncode == 0, said)
    check("live: it says whom it served", "live: 2 viewers" in said, said)
    table = rows("followed/timeseries.csv")
    check("live: every topic", len(messages) == 7, str(list(messages)))
    first = min(min(found) for found in messages.values()) // TICK_NS
    check("live: from the subscription to the end", all(len(found) == 800 - first for found in messages.values()), str(first))
    same_as_csv("live", messages, table[first:])
    alone = [json.loads((FOLDER / name / "summary.json").read_text())["command_hash"] for name in ("alone", "followed")]
    check("live: the same commands as without", alone[0] == alone[1], str(alone))
    same = (FOLDER / "alone/timeseries.csv").read_bytes() == (FOLDER / "followed/timeseries.csv").read_bytes()
    check("live: the same results as without", same)
    taken = subprocess.run([OLEO, *run, "--live", "1", "--no-out"], cwd=FOLDER, capture_output=True, text=True, check=False)
    if taken.returncode != 0:
        check("live: a port that is not to be had is one line", taken.returncode == 2 and len(taken.stderr.splitlines()) == 1, taken.stderr)


OLEO, FOLDER = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
files()
live()
print(f"{passed} passed, {failed} failed")
sys.exit(1 if failed else 0)
