"""XCP on a real CAN interface with somebody else's tools: `test_pyxcp.py PROGRAM INTERFACE`.

pya2l reads the description file. With what it says, pyxcp connects to the controller of a running `oleo hil`, reads who it is, uploads values, records a list every tick for some seconds,
and tries to write. What it recorded must be what the run's own table says: each displacement that the controller was told lies within half
a step of the bus from that in `timeseries.csv`, and each valve word is the same. No time is asserted.
"""

import contextlib
import csv
import json
import logging
import os
import pathlib
import struct
import subprocess
import sys
import tempfile
import time
import unittest

import can
import pya2l
from pya2l import model
from pyxcp.config import create_application_from_config, reset_application
from pyxcp.daq_stim import DaqList, DaqOnlinePolicy
from pyxcp.master import Master
from pyxcp.types import XcpResponseError

PROGRAM, INTERFACE = sys.argv[1:3]


class Description:
    """What the program's description file says, as pya2l reads it: places, types, and how to connect."""

    KINDS = {"UBYTE": "U8", "UWORD": "U16", "ULONG": "U32", "FLOAT32_IEEE": "F32"}

    def __init__(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "oleo.a2l")
            subprocess.run([PROGRAM, "a2l", "--out", file], check=True, capture_output=True)
            session = pya2l.import_a2l(file, in_memory=True, progress_bar=False, loglevel="ERROR")
        module = session.query(model.Module).one()
        self.epk = module.mod_par.epk.identifier
        self.places = {one.name: (one.ecu_address.address, self.KINDS[one.datatype]) for one in module.measurement}
        self.places |= {one.name: (one.address, "F32") for one in module.characteristic}
        self.ranges = {one.name: (one.lowerLimit, one.upperLimit) for one in module.characteristic}
        (layers, transports), = (list(block["XCP"]) for block in session.parse_ifdata(module.if_data))
        self.can = transports["XCP_ON_CAN"][1]
        self.events = layers["DAQ"][-1]["EVENT"]


FORMATS = {"U8": "<B", "U16": "<H", "U32": "<I", "F32": "<f"}


def yields_to_the_tool():
    """In lockstep the run is as fast as it can, and would fill the tool's socket faster than Python empties it. So it shares one
    processor with the tool and runs only while the tool has nothing to do."""
    os.sched_setaffinity(0, PROCESSOR)
    os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))


PROCESSOR = {min(os.sched_getaffinity(0))}


@contextlib.contextmanager
def driving(folder, *arguments):
    """A run of 8000 ticks whose results are in the folder when the block has ended; begins when the controller commands."""
    command = [PROGRAM, "hil", "--bus", f"socketcan:{INTERFACE}", "--duration-s", "40", "--out", folder, *arguments]
    with can.Bus(interface="socketcan", channel=INTERFACE, can_filters=[{"can_id": 0x0A0, "can_mask": 0x7FF}]) as bus:
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
        run = subprocess.Popen(command, preexec_fn=yields_to_the_tool, **pipes)
        heard = bus.recv(60)
    try:
        assert heard, "the run has not begun"
        yield
    finally:
        said = run.communicate(timeout=300)
        # Status 1: a check of the scenario itself, such as that of its roll angle, which is nothing to this test.
        assert run.returncode in (0, 1), said
        summary = json.loads(pathlib.Path(folder, "summary.json").read_text())
        assert (summary["frames_lost"], summary["e2e_errors"]) == (0, 0), said


@contextlib.contextmanager
def connected(how, policy=None):
    reset_application()
    application = create_application_from_config({"General": {"disable_error_handling": True}}, log_level=logging.ERROR)
    transport = application.transport
    transport.layer, transport.timeout = "CAN", 5.0
    transport.can.interface, transport.can.channel, transport.can.bitrate = "socketcan", INTERFACE, how["BAUDRATE"]
    transport.can.can_id_master, transport.can.can_id_slave = how["CAN_ID_MASTER"], how["CAN_ID_SLAVE"]
    with Master("CAN", config=application, policy=policy) as xcp:
        xcp.connect()
        yield xcp
        xcp.disconnect()


def refused(call, *arguments):
    """The name of the error with which a command is refused."""
    try:
        call(*arguments)
    except XcpResponseError as error:
        return str(error.get_error_code())
    return None


class Recorded(DaqOnlinePolicy):
    """Keeps every sample of a list."""

    def initialize(self):
        self.samples = []

    def on_daq_list(self, daq_list, timestamp0, timestamp1, payload):
        self.samples.append((timestamp1, payload))

    def finalize(self):
        pass


class XcpOnCan(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.description = Description()

    def read(self, xcp, name):
        address, kind = self.description.places[name]
        data = xcp.shortUpload(struct.calcsize(FORMATS[kind]), address, 0)
        return struct.unpack(FORMATS[kind], bytes(data))[0]

    def write(self, xcp, name, value):
        xcp.setMta(self.description.places[name][0])
        return refused(xcp.download, struct.pack("<f", value))

    def test_a_tool_reads_and_records_what_the_run_says(self):
        names = ["plant_tick", "mode", "valve_word", "displacement_front_left_m"]
        measured = [(name, self.description.places[name][0], 0, self.description.places[name][1]) for name in names]
        recorder = Recorded([DaqList("tick", 0, False, True, measured, priority=0, prescaler=1)])
        with tempfile.TemporaryDirectory() as folder:
            with driving(folder, "--xcp", "--scenario", "lane-change-on-belgian"), connected(self.description.can, recorder) as xcp:
                self.assertTrue(xcp.slaveProperties["supportsDaq"])
                self.assertFalse(xcp.slaveProperties["supportsCalpag"], "this slave does not write")
                identity = xcp.identifier(0)
                self.assertEqual(identity, self.description.epk, "the file is that of this slave")
                self.assertEqual(xcp.identifier(1), "oleo")
                self.assertEqual(xcp.getDaqProcessorInfo().maxEventChannel, len(self.description.events))
                self.assertLess(self.read(xcp, "tick"), self.read(xcp, "tick"))
                self.assertAlmostEqual(self.read(xcp, "tuning.spring.trapped_shift_m"), 0.008, places=6)
                self.assertEqual(self.write(xcp, "tuning.spring.trapped_shift_m", 0.01), "ERR_WRITE_PROTECTED")
                xcp.setMta(0x2000)
                self.assertEqual(xcp.buildChecksum(64).checksumType, "XCP_CRC_32")
                recorder.setup()
                recorder.start()
                while len(recorder.samples) < 1000:
                    time.sleep(0.1)
                recorder.stop()
            with open(pathlib.Path(folder, "timeseries.csv"), newline="") as file:
                rows = list(csv.DictReader(file))
        names = [header[0] for header in recorder.daq_lists[0].headers]
        self.compare(recorder.samples, names, rows)

    def compare(self, samples, names, rows):
        stamps = [stamp for stamp, _ in samples]
        ticks = [round((stamp - stamps[0]) / 5_000_000) for stamp in stamps]
        self.assertEqual(ticks, list(range(len(samples))), "a sample in each tick, and none is lost")
        samples = [dict(zip(names, payload)) for _, payload in samples]
        # The plant's tick is sent modulo 256; of the ticks that it may be, one has the readings.
        read = [sample["displacement_front_left_m"] for sample in samples]
        driven = [float(row["displacement_front_left_m"]) for row in rows]

        def worst(first):
            return max(abs(a - b) for a, b in zip(read, driven[first:]))

        begins = range(int(samples[0]["plant_tick"]), len(rows) - len(samples), 256)
        first = min(begins, key=worst)
        self.assertLess(worst(first), 0.5e-5 + 1e-8, "half a step of the bus")
        for sample, row in zip(samples, rows[first:]):
            self.assertEqual(int(sample["valve_word"]), int(float(row["valve_word"])))
        words = {int(sample["valve_word"]) for sample in samples}
        print(f"DAQ: {len(samples)} samples, a tick apart, none lost; displacement within {1e6 * worst(first):.1f} um of the run, "
              f"valve words equal ({len(words)} different)")

    def test_where_the_build_and_the_user_permit_it_a_tool_writes_within_bounds(self):
        shift, rough = "tuning.spring.trapped_shift_m", "tuning.strategy.road_and_cornering.rough_m_s2"
        with tempfile.TemporaryDirectory() as folder:
            with driving(folder, "--xcp", "--xcp-write", "--road", "flat"), connected(self.description.can) as xcp:
                self.assertTrue(xcp.slaveProperties["supportsCalpag"])
                while self.read(xcp, "mode") != 1:
                    time.sleep(0.1)
                time.sleep(0.2)
                self.assertIsNone(self.write(xcp, shift, 0.012))
                self.assertAlmostEqual(self.read(xcp, shift), 0.012, places=6)
                least, most = self.description.ranges[shift]
                self.assertEqual(self.write(xcp, shift, 1.01 * most), "ERR_OUT_OF_RANGE")
                self.assertEqual(self.write(xcp, shift, 0.99 * least), "ERR_OUT_OF_RANGE")
                self.assertIsNone(self.write(xcp, shift, most))
                self.assertIsNone(self.write(xcp, shift, 0.012))
                self.assertEqual(self.write(xcp, shift, float("nan")), "ERR_OUT_OF_RANGE")
                self.assertEqual(self.write(xcp, rough + ".end", 0.3), "ERR_OUT_OF_RANGE", "above the other threshold")
                self.assertAlmostEqual(self.read(xcp, shift), 0.012, places=6)
                xcp.setMta(self.description.places["mode"][0])
                self.assertEqual(refused(xcp.download, bytes(4)), "ERR_ACCESS_DENIED", "a measured value")
            soft = ["--strategy", "always-soft"]
            with driving(folder, "--xcp", "--xcp-write", *soft), connected(self.description.can) as xcp:
                while self.read(xcp, "valve_word") == 0:
                    time.sleep(0.1)
                answer = self.write(xcp, shift, 0.012)
                self.assertEqual(answer, "ERR_RESOURCE_TEMPORARY_NOT_ACCESSIBLE", "valves are open")
        print("writing: accepted in its range while the valves are closed, refused outside of it and while they are open")


if __name__ == "__main__":
    os.sched_setaffinity(0, PROCESSOR)
    unittest.main(argv=sys.argv[:1], verbosity=1)
