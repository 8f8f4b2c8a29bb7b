"""The controller as a node on CAN (FMI-LS-BUS) in FMPy: `test_can.py OLEO LIBRARY`.

A bus of 500 kbit/s (`wire.py`) carries its frames: to a recording of `oleo hil`, and to the vehicle as an FMU whose frames are written by cantools and an independent
end-to-end protection. Operations are read and written by `ls_bus.py`.
"""

import contextlib
import pathlib
import struct
import tempfile
import unittest
import zipfile

import cantools
import e2e.p02
import fmpy
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu
from lxml import etree

import ls_bus
from instances import LIBRARY, Fmu, oleo
from wire import BIT_S, TICK, Bus, Node, bits

DATABASE = cantools.database.load_file(str(pathlib.Path(__file__).parents[2] / "controller" / "oleo.dbc"))
COMMAND, STATUS = 0x0A0, 0x300
OWN = (COMMAND, STATUS)
TICK_S = TICK * BIT_S
CORNERS = ["front_left", "front_right", "rear_left", "rear_right"]
VALVES = [f"valve{valve}_{corner}" for corner in CORNERS for valve in (1, 2, 3)]
IN_DATABASE = [f"Valve{valve}_{corner}" for corner in ("FrontLeft", "FrontRight", "RearLeft", "RearRight") for valve in (1, 2, 3)]
READINGS = [f"displacement_{corner}_m" for corner in CORNERS] + [f"p{point}_{corner}_Pa" for corner in CORNERS for point in (1, 2, 3, 4)]
NOTIFICATIONS = "org.fmi_standard.fmi_ls_bus.Can_BusNotifications"


def word(data):
    """The valve word of a command."""
    signals = DATABASE.decode_message(COMMAND, data, decode_choices=False)
    return sum(signals[name] << bit for bit, name in enumerate(IN_DATABASE))


def changes(words):
    """Where a line of words changes, and to what."""
    return [(k, words[k]) for k in range(1, len(words)) if words[k] != words[k - 1]]


class Recorded:
    """The plant's half of a recording: it sends again what was sent, in each tick at its begin."""

    period = TICK

    def __init__(self, path):
        self.sent, self.own, self.ends = [], [], []
        for line in path.read_text().splitlines():
            stamp, _, frame = line.split()
            identifier, data = frame.split("#")
            identifier, data = int(identifier, 16), bytes.fromhex(data)
            at = float(stamp.strip("()"))
            # A stamp is the end of the frame on the wire.
            (self.own if identifier in OWN else self.sent).append((int(at / TICK_S), identifier, data))
            self.ends.append((round(at / BIT_S), identifier, data))
        self.heard = []

    def at(self, now):
        frames = []
        while self.sent and self.sent[0][0] == now // TICK:
            frames.append(self.sent.pop(0)[1:])
        return frames

    def hear(self, identifier, data):
        self.heard.append((identifier, data))


class Driven:
    """The vehicle as an FMU behind the database: six sensor messages a tick, and valves that follow the command at the next millisecond."""

    period = TICK // 5

    def __init__(self, vehicle):
        self.vehicle, self.tick, self.answer, self.words = vehicle, 0, 0, []
        self.command = 0
        self.counters = {}

    def protected(self, name, signals):
        message = DATABASE.get_message_by_name(name)
        data = bytearray(message.encode({"E2E_Crc": 0, "E2E_Counter": 0, **signals}))
        counter = self.counters[name] = (self.counters.get(name, 0) + 1) % 16
        data[1] = data[1] & 0xF0 | counter
        e2e.p02.e2e_p02_protect(data, bytes.fromhex(message.dbc.attributes["E2E_DataIdList"].value), increment_counter=False)
        return message.frame_id, bytes(data)

    def at(self, now):
        if now:
            self.vehicle.set_all({name: bool(self.command >> bit & 1) for bit, name in enumerate(VALVES)})
            self.vehicle.step(self.period * BIT_S)
        if now % TICK:
            return []
        self.words.append(self.command)
        values = dict(zip(READINGS, self.vehicle.get(*READINGS)))
        frames = [
            self.protected(f"PRESSURE_{corner.upper()}", {f"P{point}": values[f"p{point}_{corner}_Pa"] for point in (1, 2, 3, 4)})
            for corner in CORNERS
        ] + [
            self.protected(f"DISPLACEMENT_{axle.upper()}", {
                "PlantTick": self.tick % 256, "Answer": self.answer, "StatusLeft": 0, "StatusRight": 0,
                "DisplacementLeft": values[f"displacement_{axle}_left_m"], "DisplacementRight": values[f"displacement_{axle}_right_m"],
            })
            for axle in ("front", "rear")
        ]
        self.tick += 1
        return frames

    def hear(self, identifier, data):
        if identifier == COMMAND:
            self.answer = DATABASE.decode_message(COMMAND, data)["Challenge"]
            self.command = word(data)


class Can(unittest.TestCase):
    """The node on a bus."""

    @classmethod
    def setUpClass(cls):
        cls.stack = contextlib.ExitStack()
        cls.folder = pathlib.Path(cls.stack.enter_context(tempfile.TemporaryDirectory(prefix="oleo can ")))
        cls.fmu = Fmu(cls.folder, "can-controller", 3)
        cls.stack.callback(cls.fmu.close)

    @classmethod
    def tearDownClass(cls):
        cls.stack.close()

    def node(self, notified=False, behaviour=0, name="node"):
        """An instance in the event mode with which it begins."""
        instance = self.fmu.instance(name, events=True)
        slave = instance.slave
        slave.enterConfigurationMode()
        slave.setBoolean([self.fmu.reference[NOTIFICATIONS]], [notified])
        slave.exitConfigurationMode()
        slave.enterInitializationMode(startTime=0.0)
        slave.setInt64([self.fmu.reference["arbitration_lost"]], [behaviour])
        slave.exitInitializationMode()
        return Node(instance)

    def recording(self, scenario, *arguments):
        """What a run of our own loop has recorded."""
        out = self.folder / scenario
        if not out.exists():
            status, _, complained = oleo("hil", "--scenario", scenario, *arguments, "--out", out)
            self.assertIn(status, (0, 1), complained)
        return Recorded(out / "candump.log")

    def test_a_validator_finds_nothing_and_the_files_of_the_standard_are_there(self):
        self.assertEqual(validate_fmu(str(self.fmu.path)), [])
        self.assertIn("FMI 3.0", self.fmu.said)
        schemas = pathlib.Path(fmpy.__file__).parent / "schema" / "fmi3"
        with zipfile.ZipFile(self.fmu.path) as archive:
            terminals = etree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
            description = etree.fromstring(archive.read("modelDescription.xml"))
            manifest = etree.fromstring(archive.read("extra/org.fmi-standard.fmi-ls-bus/fmi-ls-manifest.xml"))
        etree.XMLSchema(etree.parse(schemas / "fmi3TerminalsAndIcons.xsd")).assertValid(terminals)
        (terminal,) = terminals.iter("Terminal")
        self.assertEqual(terminal.get("terminalKind"), "org.fmi-ls-bus.network-terminal")
        self.assertEqual(terminal.get("matchingRule"), "org.fmi-ls-bus.transceiver")
        members = {member.get("memberName"): member.get("variableName") for member in terminal}
        self.assertEqual(set(members), set(Node.MEMBERS))
        of = {variable.name: variable for variable in self.fmu.description.modelVariables}
        for member, name in members.items():
            variable = of[name]
            self.assertEqual(variable.causality, "input" if member.startswith("Rx") else "output")
            if member.endswith("Data"):
                (binary,) = description.iterfind(f".//Binary[@name='{name}']")
                self.assertEqual(binary.get("mimeType"), 'application/org.fmi-standard.fmi-ls-bus.can; version="1.0.0"')
                self.assertEqual([clock.name for clock in variable.clocks], [members[member.replace("Data", "Clock")]])
            else:
                self.assertEqual(variable.intervalVariability, "triggered")
        self.assertEqual(of[NOTIFICATIONS].causality, "structuralParameter")
        self.assertEqual((of[NOTIFICATIONS].variability, of[NOTIFICATIONS].start), ("fixed", "false"))
        self.assertTrue(self.fmu.description.coSimulation.hasEventMode)
        namespace = "{http://fmi-standard.org/fmi-ls-manifest}"
        self.assertEqual(manifest.tag, "fmiLayeredStandardManifest")
        self.assertEqual(manifest.get(namespace + "fmi-ls-name"), "org.fmi-standard.fmi-ls-bus")
        self.assertEqual(manifest.get(namespace + "fmi-ls-version"), "1.0.0")
        self.assertEqual(manifest.get("isBusSimulationFMU"), "false")

    def replayed(self, scenario, notified=False, behaviour=0):
        """The node's frames under the plant's frames of a recording, and those of our own loop."""
        recorded = self.recording(scenario)
        node = self.node(notified, behaviour)
        ticks = recorded.own[-1][0] + 1
        bus = Bus(node, recorded, notified)
        bus.run((ticks + 1) * TICK - 1)
        self.assertEqual(node.bit_rate, 500_000)
        self.assertEqual(node.format_errors, [])
        return recorded, bus

    def test_under_the_frames_of_our_own_loop_it_sends_the_frames_of_our_own_loop(self):
        total = switched = 0
        later = []
        for scenario in ("belgian", "lane-change-on-belgian", "corrupt-burst", "masquerade", "held-up-bus"):
            with self.subTest(scenario):
                recorded, bus = self.replayed(scenario)
                own = [(identifier, data) for _, identifier, data in recorded.own]
                self.assertEqual(recorded.heard, own)
                words = [word(data) for identifier, data in own if identifier == COMMAND]
                here, there = (
                    [end for end, identifier, _ in line if identifier == COMMAND] for line in (bus.ends, recorded.ends)
                )
                later += [one - other for one, other in zip(here, there)]
                total, switched = total + len(words), switched + len(changes(words))
        print(f"CAN: {total} commands and all states are those of our own loop, byte by byte, with {switched} changes of the valve word, "
              f"{1e3 * BIT_S * min(later):.1f} to {1e3 * BIT_S * max(later):.1f} ms later on the wire")
        self.assertGreater(switched, 20)
        self.assertLessEqual(max(later), TICK)

    def test_frames_take_as_long_as_in_our_own_loop(self):
        """`oleo hil` computes when each frame would have ended on the wire; this bus is another program."""
        recorded = self.recording("belgian")
        # The first tick, in which all frames follow each other.
        at = 0
        for end, identifier, data in recorded.ends[:8]:
            at += bits(identifier, data)
            self.assertEqual(end, at)

    def test_a_bus_that_confirms_and_one_that_discards_change_nothing(self):
        expected, _ = self.replayed("corrupt-burst")
        for behaviour, name in enumerate(("buffer", "discard")):
            recorded, bus = self.replayed("corrupt-burst", notified=True, behaviour=behaviour)
            self.assertEqual(recorded.heard, expected.heard, name)
            self.assertEqual(bus.node.behaviour, 1 + behaviour)
            self.assertEqual(bus.node.statuses, [ls_bus.ACTIVE])
            # The state has the lowest priority, and loses against what is sent at the same time.
            self.assertEqual(bus.lost > 100, behaviour == 1)
            self.assertEqual(bus.node.instance.get("frames_dropped", "transmit_errors"), (0.0, 0.0))

    def test_a_node_whose_frames_are_destroyed_goes_bus_off_and_comes_back(self):
        recorded = self.recording("belgian")
        node = self.node(notified=True)

        def destroys(identifier, start):
            return identifier in OWN and TICK * 300 <= start < TICK * 320

        bus = Bus(node, recorded, True, destroys)
        bus.run(300 * TICK - 1)
        self.assertEqual(node.instance.get("can_status", "transmit_errors"), (0, 0.0))
        while node.instance.get("can_status") != (2,):
            bus.run(bus.now + TICK // 5)
            self.assertLess(bus.now, 320 * TICK)
        # 128 frames of others at six a tick, and the controller, which hears nothing, closes its valves.
        off = bus.now
        while node.instance.get("can_status") == (2,):
            bus.run(bus.now + TICK // 5)
        self.assertEqual(node.statuses[:3], [ls_bus.ACTIVE, ls_bus.PASSIVE, ls_bus.OFF])
        self.assertAlmostEqual((bus.now - off) / TICK, 128 / 6, delta=1.5)
        bus.run(bus.now + TICK)
        self.assertEqual(node.statuses[3:], [ls_bus.ACTIVE])
        self.assertEqual(node.instance.get(*VALVES), (False,) * 12)
        self.assertGreater(node.instance.get("frames_dropped")[0], 0)

    def test_what_cannot_be_read_is_given_back(self):
        node = self.node()
        node.event()
        good = ls_bus.transmit(0x7FF, b"ab")
        unknown = struct.pack("<II", 0x77, 11) + b"xyz"
        no_identifier = ls_bus.transmit(0x800, b"")
        too_long = ls_bus.transmit(0x110, bytes(9))
        for bad, given in [
            (unknown, [unknown]), (good + unknown + good, [unknown]), (no_identifier, [no_identifier]), (too_long, [too_long]),
            (good[:-1], [good[:-1]]), (good[:5], [good[:5]]), (unknown + good[:-1], [unknown, good[:-1]]),
            (ls_bus.write(ls_bus.FORMAT_ERROR, good), []), (ls_bus.write(ls_bus.FORMAT_ERROR, good)[:-1], []),
        ]:
            node.format_errors.clear()
            node.slave.enterEventMode()
            node.event(bad)
            node.step(1e-4) and (node.slave.enterEventMode(), node.event())
            self.assertEqual(node.format_errors, given, bad)
        self.assertEqual(node.instance.get("format_errors"), (10.0,))
        with self.assertRaises(FMICallException):
            node.step(1e-7)
        self.assertTrue(node.instance.lines[-1].startswith("the step is 0.0000001 s: must be from 1e-6 to 10 s"), node.instance.lines)

    def test_instances_are_their_own_and_a_written_state_goes_on_in_another(self):
        recorded, again, other = (self.recording("belgian") for _ in range(3))
        one, two = Bus(self.node(name="one"), recorded, False), Bus(self.node(True, 1, "two"), other, True)
        half, end = 500 * TICK + 700, 1000 * TICK
        for until in range(0, half, 50 * TICK):
            one.run(until)
            two.run(until)
        one.run(half)
        written = one.node.instance.written_state()
        then = (one.now, list(one.waiting), one.current, list(recorded.sent), len(recorded.heard))
        one.run(end)
        expected = recorded.heard[then[4]:]
        node = self.node(True, 1, "three")
        node.instance.read_state(written)
        third = Bus.__new__(Bus)
        again.sent = then[3]
        third.__dict__.update(one.__dict__, node=node, plant=again, now=then[0], waiting=then[1], current=then[2])
        third.run(end)
        self.assertEqual(again.heard, expected)
        two.run(end)
        self.assertEqual(other.heard, recorded.heard)

    def test_on_the_bus_of_the_vehicle_it_decides_as_in_our_own_loop(self):
        """The vehicle is an FMU too; its frames are written by cantools."""
        ticks = 1200
        drive = ["--road", "belgian", "--speed-km-h", "40"]
        with contextlib.ExitStack() as stack:
            vehicles = Fmu(self.folder, "vehicle", 2, *drive)
            controllers = Fmu(self.folder, "controller", 2)
            for fmu in (vehicles, controllers):
                stack.callback(fmu.close)
            node = self.node()
            plant = Driven(vehicles.instance("vehicle").start())
            bus = Bus(node, plant, False)
            bus.run(ticks * TICK)
            # Our own loop: the controller steps first, without a bus.
            vehicle, controller = vehicles.instance("own").start(), controllers.instance("own").start()
            own = []
            for _ in range(ticks):
                controller.set_all(dict(zip(READINGS, vehicle.get(*READINGS))))
                controller.step(TICK_S)
                signals = dict(zip(VALVES, map(bool, controller.get(*VALVES))))
                own.append(sum(signal << bit for bit, signal in enumerate(signals.values())))
                vehicle.set_all(signals)
                vehicle.step(TICK_S)
            self.assertEqual(node.instance.get("mode", "fault", "can_status"), (1, 0, 0))
        on_bus = [word(data) for _, identifier, data in bus.ends if identifier == COMMAND]
        there, here = changes(on_bus), changes(own)
        self.assertEqual([value for _, value in there], [value for _, value in here])
        apart = [one - other for (one, _), (other, _) in zip(there, here)]
        print(f"CAN: with the vehicle {len(apart)} changes of the valve word as in our own loop, {min(apart)} to {max(apart)} ticks apart")
        self.assertGreater(len(apart), 2)
        self.assertLessEqual(max(map(abs, apart)), 8)

    def test_the_command_complains_in_one_line(self):
        out = self.folder / "none.fmu"
        status, _, complained = oleo("fmu", "can-controller", "--fmi", 2, "--library", LIBRARY, "--out", out)
        self.assertEqual((status, complained.count("\n")), (2, 1))
        self.assertIn("FMI 2.0 has no variables for: write FMI 3.0 with --fmi 3", complained)
        instance = None
        with self.assertRaises(Exception):
            instance = self.fmu.instance("without", events=False)
        self.assertIsNone(instance)


if __name__ == "__main__":
    unittest.main(verbosity=1)
