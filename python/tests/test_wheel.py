"""The wheel gives what the command line gives, to the last bit, and complains in one line: `test_wheel.py OLEO`.

OLEO is the program; the wheel and its dependencies are on the path. Campaigns are simulated, so that nothing outside is needed.
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np
import pandas as pd

import oleo

OLEO = pathlib.Path(sys.argv.pop(1)).resolve() if len(sys.argv) > 1 else pathlib.Path("target/release/oleo")
#: Keys of report.json that say how it was made.
OF_THE_RUN = {"runtime_s", "command", "version", "inputs"}

GAS_SPRING = """[specimen]
name = "spring"
kind = "gas spring"
[chamber]
area_m2 = 0.01
volume_at_zero_m3 = 0.03
[gas]
species = "nitrogen"
process = "adiabatic"
temperature_K = 293.15
[noise]
displacement_m = 1e-5
p_Pa = 300.0
"""
HEAT = "[effects.gas_heat_transfer]\ntime_constant_s = 6.0\n"


def run(*arguments, folder=None):
    """What the program prints."""
    done = subprocess.run([OLEO, *map(str, arguments)], cwd=folder, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def strokes(pause_s):
    """Time and displacement of strokes with holds."""
    time_s = 0.05 * np.arange(1200)
    at = time_s % (20.0 + pause_s)
    return time_s, (np.clip(at - 5.0, 0.0, 5.0) - np.clip(at - 13.0, 0.0, 5.0)) / 10.0


def recorded(pause_s, seed):
    """A recording of the gas spring that exchanges heat with its wall."""
    time_s, displacement_m = strokes(pause_s)
    motion = pd.DataFrame({"time_s": time_s, "displacement_m": displacement_m, "p_Pa": 1e6})
    truth = oleo.predict(oleo.Model(GAS_SPRING + HEAT), motion)
    noise = np.random.default_rng(seed).normal(size=(2, len(time_s)))
    return pd.DataFrame(
        {
            "time_s": time_s,
            "displacement_m": displacement_m + 1e-5 * noise[0],
            "p_Pa": truth["p_Pa"].to_numpy() + 300.0 * noise[1],
        }
    )


def of_the_command(frame, path):
    """A data frame with the bits that a CSV file holds, which has every digit."""
    frame.to_csv(path, index=False)
    return read(path)


def read(path):
    """A CSV file, with the numbers that are written in it. (pandas's own way with them has changed over its versions.)"""
    table = pd.read_csv(path, dtype=str, keep_default_na=False)
    return table.apply(lambda column: column if column.name in ("mode", "fault") else column.map(float))


class SameAsTheCommandLine(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def campaign(self):
        folder = self.folder / "campaign"
        folder.mkdir()
        (folder / "model.toml").write_text(GAS_SPRING)
        # Names whose order differs with and without the end of a file's name.
        names = {"run": 0.0, "run-b": 1.0, "run10": 2.0}
        frames = {n: of_the_command(recorded(p, k), folder / f"{n}.csv") for k, (n, p) in enumerate(names.items())}
        return folder, dict(reversed(frames.items()))

    def test_diagnosis(self):
        folder, frames = self.campaign()
        for hold_out in [], ["run-b"]:
            options = [word for name in hold_out for word in ("--hold-out", name)]
            status, said, error = run("diagnose", folder, *options, "--out", self.folder / "command", "--force")
            self.assertEqual(status, 0, error)
            found = oleo.diagnose(frames, folder / "model.toml", hold_out=hold_out)
            page = found.report(self.folder / "wheel", force=True)
            reports = [json.loads((self.folder / who / "report.json").read_text()) for who in ("command", "wheel")]
            for report in reports:
                for key in OF_THE_RUN:
                    report.pop(key)
            self.assertEqual(*reports)
            models = [(self.folder / who / "model.toml").read_bytes() for who in ("command", "wheel")]
            self.assertEqual(*models)
            self.assertEqual(found.model.to_toml().encode(), models[0])
            self.assertTrue(said.startswith(str(found)), said)
            self.assertTrue(page.is_file())
            self.assertEqual((found.verdict, [e.id for e in found.effects]), ("missing_physics", ["gas_heat_transfer"]))
            frame = found.effects.to_frame()
            self.assertEqual(list(frame["parameter"]), [p.key for p in found.effects[0].parameters])
            self.assertLess(abs(frame["value"][0] - 6.0), 0.2)
            self.assertLess(frame["ci95_low"][0], frame["ci95_high"][0])

    def test_prediction(self):
        folder, frames = self.campaign()
        out = self.folder / "predicted.csv"
        status, said, error = run("predict", "--model", folder / "model.toml", folder / "run.csv", "--out", out)
        self.assertEqual(status, 0, error)
        predicted = oleo.predict(folder / "model.toml", frames["run"])
        expected = read(out)
        self.assertEqual(list(predicted), list(expected))
        for name in expected:
            # The command writes nine digits.
            written = [f"{float(f'{value:.8e}'):.8e}" for value in predicted[name]]
            self.assertEqual(written, [f"{value:.8e}" for value in expected[name]], name)
        self.assertIn(f"{predicted.attrs['noise_ratio']['p_Pa']:.2f}", said)

    def test_loop(self):
        out = self.folder / "run"
        weak = self.folder / "weak.toml"
        model = oleo.Model.built_in().to_toml()
        weak.write_text(model.replace("bore_m = 0.05", "bore_m = 0.051"))
        self.assertNotEqual(weak.read_text(), model)
        arguments = ["--scenario", "bus-silence", "--road", "iso-c", "--duration-s", "6", "--strut-at", f"rear-left={weak}"]
        status, _, error = run("hil", *arguments, "--out", out)
        self.assertIn(status, (0, 1), error)
        frame = oleo.hil("bus-silence", road="iso-c", duration_s=6, strut_at={"rear-left": weak})
        summary = json.loads((out / "summary.json").read_text())
        own = frame.attrs["summary"]
        for key in own.keys() - {"wall_s", "real_time_factor"}:
            self.assertEqual(own[key], summary[key], key)
        self.assertEqual(frame.attrs["passed"], status == 0)
        expected = read(out / "timeseries.csv")
        self.assertEqual(list(frame), list(expected))
        for name in expected:
            if name in ("mode", "fault"):
                self.assertEqual(list(frame[name]), list(expected[name]))
            else:
                written = [f"{float(value):.8e}" for value in frame[name]]
                self.assertEqual(written, [f"{float(value):.8e}" for value in expected[name]], name)

    def test_drive(self):
        out = self.folder / "drive"
        arguments = ["--manoeuvre", "lane-change", "--setting", "soft,controlled", "--speed-km-h", "50"]
        status, _, error = run("drive", *arguments, "--out", out)
        self.assertEqual(status, 0, error)
        frames = oleo.drive("lane-change", setting=["soft", "controlled"], speed_km_h=50)
        summary = json.loads((out / "summary.json").read_text())
        for name, frame in frames.items():
            for key, value in frame.attrs["figures"].items():
                self.assertEqual(value, summary[name][key], (name, key))
            expected = read(out / f"{name}.csv")
            self.assertEqual(list(frame), list(expected))
            for title in expected:
                written = [f"{value:.8e}" for value in frame[title]]
                self.assertEqual(written, [f"{value:.8e}" for value in expected[title]], title)
        one = oleo.drive("lane-change", setting="soft", speed_km_h=50)
        pd.testing.assert_frame_equal(one, frames["soft"], check_exact=True)

    def test_replay(self):
        model = oleo.Model.built_in()
        time_s = 0.005 * np.arange(400)
        displacement = 0.03 * np.sin(2.0 * np.pi * time_s)
        valves = np.stack([time_s > 0.5, time_s > 1.0, time_s > 1.5], axis=1)
        replayed = oleo.Strut(model).replay(time_s, displacement, valves)
        self.assertEqual(replayed.shape, (400, 5))
        self.assertTrue(np.array_equal(replayed, oleo.Strut(model).replay(time_s, displacement, valves.astype(int))))
        columns = {"time_s": time_s, "displacement_m": displacement, "valve1": valves[:, 0]}
        columns |= {"valve2": valves[:, 1], "valve3": valves[:, 2]}
        frame = pd.DataFrame({name: np.asarray(values, float) for name, values in columns.items()})
        # The model states the noise of the displacement, by which a recording is smoothed.
        smoothed = oleo.Strut(model).replay(time_s, displacement, valves, noise_m=5e-6)
        predicted = oleo.predict(model, frame)
        for at, name in enumerate(oleo.Strut.CHANNELS):
            self.assertTrue(np.array_equal(predicted[name], smoothed[:, at]), name)


class Complaints(unittest.TestCase):
    def complaint(self, call):
        with self.assertRaises(oleo.OleoError) as caught:
            call()
        line = str(caught.exception)
        self.assertNotIn("\n", line)
        return line

    def test_recordings(self):
        model = oleo.Model(GAS_SPRING, "model.toml")
        good = recorded(0.0, 1)

        def wrong(column, values=None, at=None, value=None):
            frame = good.copy()
            if at is not None:
                frame.loc[at, column] = value
            elif values is None:
                frame = frame.drop(columns=column)
            else:
                frame[column] = values
            return frame

        cases = [
            (wrong("p_Pa"), "run: column 'p_Pa' is missing; the file has: time_s, displacement_m"),
            (wrong("p_Pa", at=7, value=np.nan), "run, row 7: p_Pa is 'NaN', not a finite number"),
            (wrong("time_s", at=9, value=0.1), "run, row 9: time_s goes backwards"),
            (wrong("p_Pa", values=["a"] * len(good)), "run: column 'p_Pa' holds"),
            (wrong("p_Pa", values=1j), "run: column 'p_Pa' holds complex128, not numbers"),
            (good.rename(columns={"p_Pa": "p_bar"}), "column 'p_bar' has an unknown unit; 'p_Pa' is expected"),
            (good.head(20), "there are 20 usable samples"),
            (pd.concat([good, good["p_Pa"]], axis=1), "run: has two columns 'p_Pa'"),
            ([1, 2], "run: is list; give a pandas.DataFrame"),
            ({"time_s": [0.0, 1.0], "p_Pa": [1.0]}, "run: is no table"),
        ]
        for frame, says in cases:
            self.assertIn(says, self.complaint(lambda frame=frame: oleo.diagnose({"run": frame}, model)))
        for frame, says in [
            (wrong("p_Pa", at=7, value=np.nan), "strokes: row 7: p_Pa is NaN; a finite number is needed"),
            (wrong("p_Pa"), "strokes: there is no column p_Pa"),
            (wrong("p_Pa", values="a"), "strokes: column 'p_Pa' holds"),
        ]:
            self.assertIn(says, self.complaint(lambda frame=frame: oleo.predict(model, frame, name="strokes")))
        missing = good.astype({"p_Pa": "Float64"})
        missing.loc[3, "p_Pa"] = pd.NA
        self.assertIn("run, row 3: p_Pa is 'NaN'", self.complaint(lambda: oleo.diagnose({"run": missing}, model)))

    def test_campaign(self):
        model = oleo.Model(GAS_SPRING, "model.toml")
        frames = {"run": recorded(0.0, 1)}
        for call, says in [
            (lambda: oleo.diagnose({}, model), "campaign: holds no recording"),
            (lambda: oleo.diagnose(frames["run"], model), "give a dict of data frames by name"),
            (lambda: oleo.diagnose(frames, model, hold_out=["walk"]), "holds no recording 'walk' to hold out; it holds: run"),
            (lambda: oleo.diagnose(frames, model, hold_out=["run"]), "no recording is left to fit"),
            (lambda: oleo.diagnose(frames, model, hold_out="run"), "give a list of names"),
            (lambda: oleo.diagnose(frames, model, fit_until=2.0), "fit_until is 2.0"),
            (lambda: oleo.diagnose(frames, model, seed=-1), "seed is -1"),
            (lambda: oleo.diagnose(frames, "nowhere.toml"), "nowhere.toml: cannot read the model"),
            (lambda: oleo.diagnose(frames, oleo.Model("x = 1", "m.toml")), "m.toml"),
            (lambda: oleo.diagnose(frames, 3), "model: is int"),
        ]:
            self.assertIn(says, self.complaint(call))

    def test_arrays(self):
        strut = oleo.Strut(oleo.Model.built_in())
        time_s, displacement, valves = np.arange(5.0), np.zeros(5), np.zeros((5, 3))
        for arguments, says in [
            ((time_s.reshape(1, 5), displacement, valves), "t: has the shape (1, 5); give an array of shape (n,)"),
            ((time_s, np.zeros(4), valves), "x: has the shape (4,); give an array of shape (5,)"),
            ((time_s, displacement, np.zeros((3, 5))), "valves: has the shape (3, 5); give an array of shape (5, 3)"),
            ((time_s, displacement, valves + 0.5), "valves: a switching signal is 0 (closed) or 1 (open)"),
            ((time_s, displacement, np.full((5, 3), "a")), "valves: a switching signal is 0 (closed) or 1 (open)"),
            ((time_s, displacement * np.nan, valves), "x, row 0: is NaN, not a finite number"),
            ((time_s[::-1], displacement, valves), "t, row 1: 3 comes after 4; time must increase"),
            ((time_s.astype(str), displacement, valves), "t: holds <U32, not numbers"),
            ((time_s[:1], displacement[:1], valves[:1]), "t: has 1 values; a replay needs two or more"),
        ]:
            self.assertIn(says, self.complaint(lambda arguments=arguments: strut.replay(*arguments)))

    def test_runs(self):
        for call, says in [
            (lambda: oleo.hil("nowhere"), "nowhere"),
            (lambda: oleo.hil(speed_km_h=-1.0), "speed_km_h is -1: must be from 0 to 250"),
            (lambda: oleo.hil(speed_km_h="fast"), "speed_km_h is fast: give a number"),
            (lambda: oleo.hil(strategy="sporty"), "strategy is sporty: "),
            (lambda: oleo.hil(damper_policy="karnopp"), "damper_policy has no use in the strategy road-and-cornering"),
            (lambda: oleo.hil(driver="hard"), "driver has no use"),
            (lambda: oleo.hil(seed=-1), "seed is -1: give a whole number"),
            (lambda: oleo.hil(strut_at={"rear": "weak.toml"}), "strut_at has rear: did you mean rear-left? The corners are "),
            (lambda: oleo.hil(strut_at="weak.toml"), "strut_at is weak.toml: give corners with paths of strut models"),
            (lambda: oleo.hil(strut_at={"rear-left": "none.toml"}), "none.toml: cannot be read"),
            (lambda: oleo.drive("loop"), "manoeuvre is loop: "),
            (lambda: oleo.drive("lane-change", setting=["soft", "soft"]), "setting has soft twice"),
            (lambda: oleo.drive("lane-change", setting=[]), "setting is empty"),
            (lambda: oleo.drive("lane-change", model="ride"), "the ride model can neither steer nor brake"),
            (lambda: oleo.drive("belgian", strut="none.toml"), "none.toml: cannot read the model"),
        ]:
            self.assertIn(says, self.complaint(call))


class Alive(unittest.TestCase):
    def test_progress_is_told_and_can_stop_the_work(self):
        told = []
        oleo.hil(duration_s=5, progress=lambda phase, part: told.append((phase, part)))
        self.assertTrue(told and all(phase == "driving" and 0.0 <= part <= 1.0 for phase, part in told), told)

        def stops(phase, part):
            raise KeyboardInterrupt

        for call in (
            lambda: oleo.hil(duration_s=60, progress=stops),
            lambda: oleo.diagnose({"run": recorded(0.0, 1)}, oleo.Model(GAS_SPRING), progress=stops),
        ):
            with self.assertRaises(KeyboardInterrupt):
                call()

    def test_the_interpreter_is_released(self):
        ran = []
        worker = threading.Thread(target=lambda: ran.append(oleo.hil(duration_s=20)))
        worker.start()
        turns = 0
        while worker.is_alive():
            turns += 1
            time.sleep(0)
        worker.join()
        # A held interpreter would let this thread turn twice: before and after.
        self.assertGreater(turns, 100)
        self.assertEqual(len(ran), 1)


if __name__ == "__main__":
    unittest.main(verbosity=2)
