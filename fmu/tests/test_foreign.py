"""`oleo diagnose --fmu` on FMUs that other programs and our own wrote: `test_foreign.py OLEO LIBRARY RECORDINGS`.

The first model is written by PythonFMU, and its library needs that of Python in the process; recordings are computed here. The second is our own strut, written without seal friction, against the campaign
`labelled-05` of the folder RECORDINGS, whose specimen has it.
"""

import json
import os
import pathlib
import subprocess
import sys
import sysconfig
import tempfile
import unittest

import numpy as np

RECORDINGS = pathlib.Path(sys.argv.pop(3)).resolve()

from instances import LIBRARY, OLEO, oleo  # noqa: E402  (it takes the other arguments)

HERE = pathlib.Path(__file__).parent
MOUNT = """[inputs]
displacement_m = { column = "displacement_m", at = "end" }
speed_m_s = { rate_of = "displacement_m", at = "end" }
[outputs]
force_N = { column = "force_N", noise = 2.0 }
[parameters]
stiffness_N_m = { tolerance = 0.1 }
viscous_N_s_m = { tolerance = 0.1 }
"""
STRUT = """[inputs]
displacement_m = { column = "displacement_m", at = "begin", smooth_s = 0.008, offset_tolerance = 2e-4 }
speed_m_s = { rate_of = "displacement_m", smooth_s = 0.008 }
valve1 = { column = "valve1" }
valve2 = { column = "valve2" }
valve3 = { column = "valve3" }
[outputs]
force_N = { column = "force_N", noise = 12.0, offset_tolerance = 15.0 }
p1_Pa = { column = "p1_Pa", noise = 4e3, offset_tolerance = 15e3 }
p2_Pa = { column = "p2_Pa", noise = 4e3, offset_tolerance = 15e3 }
p3_Pa = { column = "p3_Pa", noise = 4e3, offset_tolerance = 15e3 }
p4_Pa = { column = "p4_Pa", noise = 4e3, offset_tolerance = 15e3 }
[parameters]
"accumulator[1].static_gas_volume_m3" = { tolerance = 0.01 }
"accumulator[2].static_gas_volume_m3" = { tolerance = 0.01 }
"cylinder.static_pressure_Pa" = { tolerance = 0.01 }
"cylinder.oil_volume_m3" = { tolerance = 0.03 }
"""


def diagnosed(folder, fmu, text, recordings, *further, **environment):
    """The report of a diagnosis."""
    chart = folder / "map.toml"
    chart.write_text(text)
    out = folder / "found"
    command = [OLEO, "diagnose", "--fmu", fmu, "--map", chart, *recordings, "--out", out, *further]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env={**os.environ, **environment})
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return json.loads((out / "report.json").read_text())


def mount(folder, run, stiffness, friction):
    """A recording of the mount."""
    time_s = 0.005 * np.arange(600)
    turn = 4.0 + 1.7 * run
    x = 0.008 * np.sin(turn * time_s) + 0.003 * np.sin(2.7 * turn * time_s)
    v = 0.008 * turn * np.cos(turn * time_s) + 0.003 * 2.7 * turn * np.cos(2.7 * turn * time_s)
    noise = np.random.default_rng(run).normal(0.0, 2.0, time_s.size)
    force = stiffness * x + 300.0 * v + friction * np.tanh(v / 0.002) + noise
    file = folder / f"run{run}.csv"
    columns = np.column_stack([time_s, x, force])
    np.savetxt(file, columns, delimiter=",", header="time_s,displacement_m,force_N", comments="", fmt="%.9g")
    return file


class Foreign(unittest.TestCase):
    """Somebody else's models."""

    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def test_a_model_of_another_program_lacks_friction(self):
        variables = sysconfig.get_config_vars()
        python = pathlib.Path(variables["LIBDIR"]) / variables["LDLIBRARY"]
        if python.suffix != ".so" or not python.exists():
            self.skipTest("this Python has no shared library, which FMUs of PythonFMU need")
        build = [sys.executable, "-m", "pythonfmu", "build", "-f", HERE / "sliding_mount.py", "-d", self.folder]
        subprocess.run(build, check=True, capture_output=True)
        recordings = [mount(self.folder, run, 2.1e4, 30.0) for run in range(3)]
        fmu = self.folder / "SlidingMount.fmu"
        report = diagnosed(self.folder, fmu, MOUNT, recordings, "--hold-out", "run2", LD_PRELOAD=str(python))
        effect = report["effects"][0]
        self.assertEqual((effect["id"], effect["place"]), ("unlisted", "output:force_N"))
        calibrated = {value["key"]: value["value"] for value in report["calibration"]}
        self.assertAlmostEqual(calibrated["stiffness_N_m (relative)"], 0.05, delta=0.005)
        before, _, after = [model["noise_ratio_kept_back"]["force_N"] for model in report["kept_back"]["models"][:3]]
        print(f"FMI 2: PythonFMU: {effect['law']['over']}; held out {before:.1f} as given, {after:.2f} improved")
        self.assertLess(after, 0.2 * before)

    def test_our_own_strut_lacks_the_friction_of_its_seal(self):
        campaign = RECORDINGS / "labelled" / "labelled-05"
        fmu = self.folder / "strut.fmu"
        arguments = ["fmu", "strut", "--strut", campaign / "model.toml", "--library", LIBRARY, "--out", fmu]
        self.assertEqual(oleo(*arguments)[0], 0)
        names = ["sawtooth_soft", "sine_low_soft", "slow_hold", "valve3_steps", "sine_high_soft"]
        recordings = [campaign / f"{name}.csv" for name in names]
        report = diagnosed(self.folder, fmu, STRUT, recordings, "--hold-out", "sine_high_soft")
        effect = report["effects"][0]
        self.assertEqual((effect["id"], effect["place"]), ("unlisted", "output:force_N"))
        law = effect["law"]
        friction = law["value"][1] * float(law["over"].rsplit(" ", 1)[1])
        before, _, after = [model["noise_ratio_kept_back"]["force_N"] for model in report["kept_back"]["models"][:3]]
        print(f"FMI 2: strut: {law['over']}: {friction:.0f} N (truth 117 N); held out {before:.1f} as given, {after:.2f} improved")
        self.assertAlmostEqual(friction, 117.3, delta=12.0)


if __name__ == "__main__":
    unittest.main()
