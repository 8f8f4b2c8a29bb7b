"""What FMPy makes of the FMU of a strut: `test_strut.py OLEO LIBRARY`.

OLEO is the program with the feature `fmu`, LIBRARY the shared library of the crate `oleo-fmu`. FMPy validates the file, simulates it, goes back to states, and
runs several instances at once. What it gets is compared with the command line and between the versions of FMI.
"""

import contextlib
import csv
import pathlib
import tempfile
import threading
import unittest

import fmpy
import numpy as np
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

from instances import LIBRARY, VERSIONS, Fmu, oleo

CHANNELS = ["force_N", "p1_Pa", "p2_Pa", "p3_Pa", "p4_Pa"]
STEP_S = 1e-3


def motion(time_s):
    """Displacement and speed: slow and fast at once."""
    turn, shake = 2 * np.pi * 0.5, 2 * np.pi * 4.0
    return (
        0.03 * np.sin(turn * time_s) + 0.004 * (1 - np.cos(shake * time_s)),
        0.03 * turn * np.cos(turn * time_s) + 0.004 * shake * np.sin(shake * time_s),
    )


def valves(time_s):
    """Switching signals, all closed at first."""
    return {f"valve{k}": (np.floor(time_s / (0.3705 + 0.2 * k)) % 2).astype(bool) for k in (1, 2, 3)}


def drive(instance, steps):
    """The bits of the outputs of some steps."""
    rows = []
    for _ in range(steps):
        time_s = instance.time_s
        displacement_m, speed_m_s = motion(time_s)
        signals = {name: bool(value) for name, value in valves(np.array(time_s)).items()}
        instance.set(displacement_m=float(displacement_m), speed_m_s=float(speed_m_s), **signals)
        instance.step(STEP_S)
        rows.append(instance.get(*CHANNELS))
    return np.array(rows)


class Strut(unittest.TestCase):
    """One strut."""

    @classmethod
    def setUpClass(cls):
        cls.stack = contextlib.ExitStack()
        cls.folder = pathlib.Path(cls.stack.enter_context(tempfile.TemporaryDirectory(prefix="oleo fmu ")))
        cls.model = cls.folder / "model.toml"
        cls.model.write_text(oleo("show", "strut")[1])
        cls.fmus = {version: Fmu(cls.folder, "strut", version) for version in VERSIONS}
        for fmu in cls.fmus.values():
            cls.stack.callback(fmu.close)

    @classmethod
    def tearDownClass(cls):
        cls.stack.close()

    def instances(self):
        return [fmu.instance() for fmu in self.fmus.values()]

    def test_a_validator_finds_nothing(self):
        for fmu in self.fmus.values():
            self.assertEqual(validate_fmu(str(fmu.path)), [])
            self.assertIn("5 inputs, 14 outputs", fmu.said)

    def test_every_number_has_a_unit_that_the_description_defines(self):
        for fmu in self.fmus.values():
            known = {unit.name for unit in fmu.description.unitDefinitions}
            for variable in fmu.description.modelVariables:
                if variable.name.endswith(("_m", "_Pa", "_N", "_s", "_K", "_m3")):
                    self.assertIn(variable.unit, known, variable.name)
            pressure = next(unit for unit in fmu.description.unitDefinitions if unit.name == "Pa")
            self.assertEqual((pressure.baseUnit.kg, pressure.baseUnit.m, pressure.baseUnit.s), (1, -1, -2))

    def test_the_same_file_is_written_again(self):
        for version, fmu in self.fmus.items():
            again = Fmu(self.folder, "strut", version, "--strut", self.model)
            self.stack.callback(again.close)
            self.assertEqual(again.path.read_bytes(), fmu.path.read_bytes())

    def test_both_versions_and_both_kinds_of_simulation_give_the_same_bits(self):
        two, three = (drive(instance.start(), 3000) for instance in self.instances())
        np.testing.assert_array_equal(two, three)
        for fmu in self.fmus.values():
            simulated = self.simulate(fmu, 1.0)
            np.testing.assert_allclose(
                [row[name] for row in simulated[1:] for name in CHANNELS[:1]], two[:1000, 0], rtol=1e-9
            )

    def simulate(self, fmu, stop_s):
        """FMPy's own simulation, from a table of inputs."""
        time_s = np.arange(0, stop_s + STEP_S / 2, STEP_S)
        displacement_m, speed_m_s = motion(time_s)
        columns = {"time": time_s, "displacement_m": displacement_m, "speed_m_s": speed_m_s, **valves(time_s)}
        table = np.empty(len(time_s), dtype=[(name, column.dtype) for name, column in columns.items()])
        for name, column in columns.items():
            table[name] = column
        return fmpy.simulate_fmu(
            fmu.unpacked, stop_time=stop_s, output_interval=STEP_S, input=table, output=CHANNELS, fmi_type="CoSimulation"
        )

    def test_the_strut_is_that_of_oleo_predict(self):
        stop_s, path = 6.0, self.folder / "motion.csv"
        time_s = np.arange(0, stop_s + STEP_S / 2, STEP_S)
        displacement_m, _ = motion(time_s)
        with path.open("w", newline="") as file:
            table = csv.writer(file)
            table.writerow(["time_s", "displacement_m", "valve1", "valve2", "valve3", *CHANNELS])
            for row in zip(time_s, displacement_m, *(column.astype(int) for column in valves(time_s).values())):
                table.writerow([repr(float(value)) for value in row[:2]] + list(row[2:]) + [1e6] * 5)
        exact = self.folder / "exact.toml"
        exact.write_text(self.model.read_text().replace("displacement_m = 5e-06", "displacement_m = 0.0"))
        status, _, complained = oleo("predict", "--model", exact, path, "--out", self.folder / "predicted.csv")
        self.assertEqual(status, 0, complained)
        with (self.folder / "predicted.csv").open() as file:
            predicted = [[float(row[name]) for name in CHANNELS] for row in csv.DictReader(file)]
        predicted = np.array(predicted)[1:]
        for instance in self.instances():
            simulated = drive(instance.start(), len(predicted))
            for k, name in enumerate(CHANNELS):
                off = np.sqrt(np.mean((simulated[:, k] - predicted[:, k]) ** 2)) / np.ptp(predicted[:, k])
                print(f"FMI {instance.fmu.version}: {name} differs from oleo predict by {1e3 * off:.2f} thousandths of its range")
                self.assertLess(off, 5e-3, name)

    def test_a_written_state_goes_on_elsewhere_with_the_same_bits(self):
        for fmu in self.fmus.values():
            first, second = fmu.instance("first").start(), fmu.instance("second").start(displacement_m=0.05)
            drive(first, 700)
            written = first.written_state()
            expected = drive(first, 900)
            second.read_state(written)
            np.testing.assert_array_equal(drive(second, 900), expected)
            first.read_state(written)
            np.testing.assert_array_equal(drive(first, 900), expected)
            first.free()
            second.free()

    def test_many_instances_on_threads(self):
        for fmu in self.fmus.values():
            expected, found = drive(fmu.instance().start(), 600), {}

            def work(number, fmu=fmu, found=found):
                found[number] = drive(fmu.instance(f"instance {number}").start(), 600)

            threads = [threading.Thread(target=work, args=[number]) for number in range(6)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertEqual(len(found), 6)
            for rows in found.values():
                np.testing.assert_array_equal(rows, expected)

    def test_tunable_parameters_change_the_strut_while_it_works(self):
        for fmu in self.fmus.values():
            tuned, plain = fmu.instance().start(), fmu.instance().start()
            np.testing.assert_array_equal(drive(tuned, 100), drive(plain, 100))
            tuned.set_all({"valve[1].flow_coefficient": 1e-7})
            for k in range(9):
                name = f"damper[1].pressure_drop_Pa[{k + 1}]"
                tuned.set_all({name: 2.0 * tuned.get(name)[0]})
            self.assertGreater(np.abs(drive(tuned, 900) - drive(plain, 900))[:, 0].max(), 50.0)

    def test_what_is_wrong_is_an_error_with_one_line(self):
        for instance in self.instances():
            instance.start()
            for call, line in [
                (lambda: instance.set(displacement_m=float("nan")), "displacement_m is NaN: must be from -2 to 2 m"),
                (lambda: instance.set(force_N=1.0), "force_N cannot be set: the model computes it"),
                (lambda: instance.set_all({"cylinder.bore_m": 0.06}), "cylinder.bore_m cannot be set now"),
                (lambda: instance.step(-1.0), "the step is -1 s: must be from 1e-6 to 10 s"),
                (lambda: instance.read_state((b"nonsense", 0.0)), "the serialized state is of another FMU"),
            ]:
                del instance.lines[:]
                with self.assertRaises(FMICallException):
                    call()
                self.assertEqual(len(instance.lines), 1)
                self.assertTrue(instance.lines[0].startswith(line), instance.lines)
            instance.time_s = 0.0
            instance.step(STEP_S)

    def test_the_command_complains_in_one_line(self):
        out = self.folder / "none.fmu"
        spoilt = self.folder / "spoilt.toml"
        spoilt.write_text(self.model.read_text().replace("bore_m", "boar_m"))
        faulty = self.folder / "faulty.toml"
        faulty.write_text(self.model.read_text() + "\n[effects.sensor_lag]\np1_Pa = 0.004\n")
        for arguments, complaint in [
            (["--library", self.folder / "absent.so"], "cannot be read"),
            (["--library", self.model], "is no shared library"),
            (["--library", LIBRARY, "--strut", spoilt], "did you mean bore_m?"),
            (["--library", LIBRARY, "--strut", faulty], "sensor_lag is a fault of instruments"),
            (["--library", LIBRARY, "--library", LIBRARY], "two libraries are for"),
            (["--library", LIBRARY, "--fmi", "1"], "2..=3"),
        ]:
            status, _, complained = oleo("fmu", "strut", "--out", out, *arguments)
            self.assertEqual(status, 2, complained)
            self.assertIn(complaint, complained)
            self.assertEqual(complained.count("\n"), 1)
            self.assertFalse(out.exists())


if __name__ == "__main__":
    unittest.main(verbosity=1)
