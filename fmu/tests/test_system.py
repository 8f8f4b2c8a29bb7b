"""What FMPy makes of the FMUs of vehicle and controller, alone and coupled: `test_system.py OLEO LIBRARY`.

The loop of our own is one in which the controller steps first and the vehicle under its new outputs (`cargo test -p oleo-fmu` shows that this has the bits of the
loop without FMUs). FMPy couples the two by an SSP, whose components step in parallel, so that each sees the other a tick late.
"""

import contextlib
import pathlib
import tempfile
import unittest
import zipfile
from xml.sax.saxutils import quoteattr

import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.ssp.simulation import simulate_ssp
from fmpy.validation import validate_fmu

from instances import LIBRARY, VERSIONS, Fmu, oleo

TICK_S = 0.005
TICKS = 1200
CORNERS = ["front_left", "front_right", "rear_left", "rear_right"]
VALVES = [f"valve{valve}_{corner}" for corner in CORNERS for valve in (1, 2, 3)]
READINGS = [f"displacement_{corner}_m" for corner in CORNERS] + [f"p{point}_{corner}_Pa" for corner in CORNERS for point in (1, 2, 3, 4)]
SEEN = ["roll_rad", "heave_m", "force_front_left_N", "speed_m_s"]


def ssp(path, vehicle, controller):
    """Vehicle and controller as a system whose connections go by name."""
    connector = '<ssd:Connector name={} kind={}><ssc:{}/></ssd:Connector>'
    component = (
        '<ssd:Component name={} type="application/x-fmu-sharedlibrary" source={}><ssd:Connectors>{}</ssd:Connectors></ssd:Component>'
    )

    def connectors(inputs, outputs):
        return "".join(
            connector.format(quoteattr(name), quoteattr(kind), "Boolean" if name in VALVES else "Real")
            for kind, names in [("input", inputs), ("output", outputs)]
            for name in names
        )

    def connections(start, end, names):
        line = '<ssd:Connection startElement="{0}" startConnector={2} endElement="{1}" endConnector={2}/>'
        return "".join(line.format(start, end, quoteattr(name)) for name in names)

    text = (
        '<?xml version="1.0" encoding="UTF-8"?><ssd:SystemStructureDescription version="1.0" name="vehicle with controller" '
        'xmlns:ssd="http://ssp-standard.org/SSP1/SystemStructureDescription" xmlns:ssc="http://ssp-standard.org/SSP1/SystemStructureCommon">'
        '<ssd:System name="loop"><ssd:Elements>'
        + component.format('"vehicle"', '"resources/vehicle.fmu"', connectors(VALVES, READINGS + SEEN))
        + component.format('"controller"', '"resources/controller.fmu"', connectors(READINGS, VALVES))
        + "</ssd:Elements><ssd:Connections>"
        + connections("vehicle", "controller", READINGS)
        + connections("controller", "vehicle", VALVES)
        + "</ssd:Connections></ssd:System></ssd:SystemStructureDescription>"
    )
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("SystemStructure.ssd", text)
        archive.write(vehicle.path, "resources/vehicle.fmu")
        archive.write(controller.path, "resources/controller.fmu")


def word(signals):
    """The valve word of twelve signals."""
    return sum(bool(signal) << bit for bit, signal in enumerate(signals))


class System(unittest.TestCase):
    """Vehicle and controller."""

    @classmethod
    def setUpClass(cls):
        cls.stack = contextlib.ExitStack()
        cls.folder = pathlib.Path(cls.stack.enter_context(tempfile.TemporaryDirectory(prefix="oleo fmu ")))
        drive = ["--road", "belgian", "--speed-km-h", "50"]
        cls.vehicles = {version: Fmu(cls.folder, "vehicle", version, *drive) for version in VERSIONS}
        cls.controllers = {version: Fmu(cls.folder, "controller", version) for version in VERSIONS}
        for fmu in [*cls.vehicles.values(), *cls.controllers.values()]:
            cls.stack.callback(fmu.close)

    @classmethod
    def tearDownClass(cls):
        cls.stack.close()

    def pair(self, version):
        return self.vehicles[version].instance("vehicle").start(), self.controllers[version].instance("controller").start()

    @staticmethod
    def tick(vehicle, controller):
        """One tick of our own loop: valve word before, what is seen after."""
        controller.set_all(dict(zip(READINGS, vehicle.get(*READINGS))))
        controller.step(TICK_S)
        signals = controller.get(*VALVES)
        vehicle.set_all(dict(zip(VALVES, map(bool, signals))))
        vehicle.step(TICK_S)
        return (word(signals), *vehicle.get(*SEEN))

    def test_a_validator_finds_nothing(self):
        for fmu in [*self.vehicles.values(), *self.controllers.values()]:
            self.assertEqual(validate_fmu(str(fmu.path)), [])
        self.assertIn("20 inputs, 21 outputs", self.controllers[2].said)

    def test_names_of_outputs_and_inputs_meet(self):
        for one, other, names in [
            (self.vehicles[2], self.controllers[2], READINGS),
            (self.controllers[2], self.vehicles[2], VALVES),
        ]:
            causality = [{v.name: v.causality for v in fmu.description.modelVariables} for fmu in (one, other)]
            self.assertEqual({causality[0][name] for name in names}, {"output"})
            self.assertEqual({causality[1][name] for name in names}, {"input"})

    def test_both_versions_are_the_same_loop_and_states_go_on_elsewhere(self):
        two = self.pair(2)
        expected = [self.tick(*two) for _ in range(TICKS)]
        self.assertGreater(len({row[0] for row in expected}), 3)
        self.assertEqual(two[1].get("mode"), (1,))
        first, second = self.pair(3), self.pair(3)
        rows = [self.tick(*first) for _ in range(TICKS // 2)]
        for old, new in zip(first, second):
            new.read_state(old.written_state())
            old.free()
        rows += [self.tick(*second) for _ in range(TICKS - len(rows))]
        self.assertEqual(rows, expected)

    def test_the_system_that_fmpy_couples_is_ours_stepped_in_parallel(self):
        path = self.folder / "loop.ssp"
        ssp(path, self.vehicles[2], self.controllers[2])
        coupled = simulate_ssp(str(path), stop_time=(TICKS - 0.5) * TICK_S, step_size=TICK_S)
        self.assertEqual(len(coupled), TICKS)
        words = np.array([word(row) for row in zip(*(coupled[f"controller.{name}"] for name in VALVES))])

        # The same by hand: both step at once under what they have shown before, which is nothing at first.
        vehicle, controller = self.pair(2)
        readings, signals = dict.fromkeys(READINGS, 0.0), dict.fromkeys(VALVES, False)
        for k in range(TICKS):
            controller.set_all(readings)
            vehicle.set_all(signals)
            controller.step(TICK_S)
            vehicle.step(TICK_S)
            readings = dict(zip(READINGS, vehicle.get(*READINGS)))
            signals = {name: bool(value) for name, value in zip(VALVES, controller.get(*VALVES))}
            self.assertEqual(word(signals.values()), words[k])
            self.assertEqual(vehicle.get(*SEEN), tuple(coupled[f"vehicle.{name}"][k] for name in SEEN))

        # Against our own loop the controller reads what was a tick ago, and the vehicle then goes its own way over the stones: the decisions are the same, and some
        # ticks apart.
        own = self.pair(2)
        own_words = np.array([self.tick(*own)[0] for _ in range(TICKS)])
        changes = [[(k, line[k]) for k in range(1, TICKS) if line[k] != line[k - 1]] for line in (words, own_words)]
        self.assertEqual(*[[word for _, word in line] for line in changes])
        apart = [abs(there - here) for (there, _), (here, _) in zip(*changes)]
        print(f"SSP: {len(apart)} changes of the valve word as in our own loop, at most {max(apart)} ticks apart")
        self.assertGreater(len(apart), 2)
        self.assertLessEqual(max(apart), 5)

    def test_wrong_steps_and_readings_are_errors_with_one_line(self):
        for version in VERSIONS:
            vehicle, controller = self.pair(version)
            for instance, call, line in [
                (controller, lambda i: i.step(0.004), "the step is 0.004 s: must be a multiple of the model's own step, 0.005 s"),
                (vehicle, lambda i: i.step(0.00015), "the step is 0.00015 s: must be a multiple of the model's own step"),
                (controller, lambda i: i.set(p1_front_left_Pa=float("nan")), "p1_front_left_Pa is NaN: must be a finite number"),
                (vehicle, lambda i: i.set(brake_force_N=-1.0), "brake_force_N is -1: must be from 0 to 1000000 N"),
            ]:
                del instance.lines[:]
                with self.assertRaises(FMICallException):
                    call(instance)
                self.assertEqual(len(instance.lines), 1)
                self.assertTrue(instance.lines[0].startswith(line), instance.lines)
                instance.time_s = 0.0

    def test_the_command_complains_in_one_line(self):
        for arguments, complaint in [
            (["vehicle", "--road", "lane.crg"], "--road lane.crg: an FMU carries built-in roads only"),
            (["vehicle", "--vehicle", self.folder / "absent.toml"], "absent.toml: cannot read the parameters"),
        ]:
            status, _, complained = oleo("fmu", *arguments, "--library", LIBRARY, "--out", self.folder / "none.fmu")
            self.assertEqual(status, 2, complained)
            self.assertIn(complaint, complained)
            self.assertEqual(complained.count("\n"), 1)


if __name__ == "__main__":
    unittest.main(verbosity=1)
