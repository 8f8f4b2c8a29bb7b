#!/usr/bin/env python3
"""The CAN database through cantools and an independent AUTOSAR profile 2.

Needs the packages `cantools` and `autosar-e2e`. Run: python3 tests/can_database.py
The last line is `N passed, N failed`; the exit status is 1 if anything failed, 2 if a package is missing.
"""

import math
import pathlib
import random
import sys

try:
    import cantools
    import e2e.p02
except ImportError as error:
    print(f"can_database.py: {error}: pip install cantools autosar-e2e", file=sys.stderr)
    sys.exit(2)

ROOT = pathlib.Path(__file__).resolve().parent.parent
DATABASE = ROOT / "controller" / "oleo.dbc"
PERIODS_MS = {0x0A0: 5, 0x110: 5, 0x111: 5, 0x112: 5, 0x113: 5, 0x114: 5, 0x115: 5, 0x300: 100, 0x301: 1000}
# The inertial unit's, which `oleo hil --imu` sends on the same bus.
UNIT_DATABASE = ROOT / "hil" / "imu.dbc"
UNIT_PERIODS_MS = {0x120: 5, 0x121: 5}

passed = failed = 0


def check(what, good):
    global passed, failed
    if good:
        passed += 1
    else:
        failed += 1
        print(f"FAILED: {what}")


db = cantools.database.load_file(str(DATABASE), strict=True)
check("identifiers", sorted(m.frame_id for m in db.messages) == sorted(PERIODS_MS))
unit_db = cantools.database.load_file(str(UNIT_DATABASE), strict=True)
check("identifiers of the unit", sorted(m.frame_id for m in unit_db.messages) == sorted(UNIT_PERIODS_MS))
lists = [m.dbc.attributes["E2E_DataIdList"].value.split() for m in db.messages + unit_db.messages]
check("data ids apart", all(len({ids[counter] for ids in lists}) == len(lists) for counter in range(16)))
random.seed(1)

bits_a_second = 0.0
for message in db.messages + unit_db.messages:
    name = message.name
    check(f"{name}: eight bytes", message.length == 8)
    check(f"{name}: period", message.cycle_time == (PERIODS_MS | UNIT_PERIODS_MS).get(message.frame_id))
    check(f"{name}: comment", bool(message.comment))
    check(f"{name}: all signals commented", all(s.comment for s in message.signals))
    data_ids = bytes.fromhex(message.dbc.attributes["E2E_DataIdList"].value)
    check(f"{name}: 16 data ids below 251", len(data_ids) == 16 and max(data_ids) < 251)
    stuffable = 34 + 8 * message.length
    bits_a_second += (stuffable + 13 + (stuffable - 1) // 4) * 1000 / message.cycle_time

    for _ in range(50):
        raw = {}
        for signal in message.signals:
            least, most = (-(1 << signal.length - 1), (1 << signal.length - 1) - 1) if signal.is_signed else (0, (1 << signal.length) - 1)
            raw[signal.name] = random.randint(least, most)
        data = bytearray(message.encode(raw, scaling=False, strict=False))
        decoded = message.decode(bytes(data), decode_choices=False, scaling=False)
        check(f"{name}: round trip", decoded == raw)
        e2e.p02.e2e_p02_protect(data, data_ids, increment_counter=False)
        check(f"{name}: protected", e2e.p02.e2e_p02_check(data, data_ids))
        data[random.randrange(2, 8)] ^= 1 << random.randrange(8)
        check(f"{name}: corruption seen", not e2e.p02.e2e_p02_check(data, data_ids))

# One frame by hand: pressures of 0, 2, 10 MPa and an error.
frame = db.get_message_by_name("PRESSURE_REAR_LEFT").encode(
    {"E2E_Crc": 0, "E2E_Counter": 0, "P1": 0, "P2": 2e6, "P3": 10e6, "P4": "SensorError"})
bits = int.from_bytes(frame, "little")
check("pressure bits", bits == 1000 << 12 | 1400 << 25 | 3000 << 38 | 8190 << 51)

# One of the unit by hand: gravity upward, and two readings out of range.
frame = unit_db.get_message_by_name("IMU_SPECIFIC_FORCE").encode(
    {"E2E_Crc": 0, "E2E_Counter": 0, "SpecificForceX": -0.002, "SpecificForceY": "SensorError", "SpecificForceZ": 9.806})
bits = int.from_bytes(frame, "little")
check("specific force bits", bits == 0xFFFF << 12 | 0x8000 << 28 | 4903 << 44)

# The vector of controller/tests/end_to_end_protection.rs: zeros, counter 1, data ids 1 to 16.
example = bytearray([0, 1, 0, 0, 0, 0, 0, 0])
e2e.p02.e2e_p02_protect(example, bytes(range(1, 17)), increment_counter=False)
check("vector of the Rust tests", example[0] == 0x1B)

for rate in (500e3, 1e6):
    load = bits_a_second / rate
    print(f"bus load at {rate / 1e3:.0f} kbit/s, worst case: {100 * load:.2f} %")
    check(f"load at {rate}", load < 0.6 and math.isfinite(load))

print(f"{passed} passed, {failed} failed")
sys.exit(1 if failed else 0)
