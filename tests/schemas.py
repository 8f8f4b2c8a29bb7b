"""Holds what the commands write against the JSON Schemas that `oleo show schema` prints, with a validator of others.

    schemas.py OLEO FOLDER

OLEO is the binary, FOLDER an empty folder in which the commands run. Each command is as short as it can be.
"""

import json
import pathlib
import subprocess
import sys

import jsonschema

# Schema, arguments.
COMMANDS = [
    ("hil", ["hil", "--duration-s", "1"]),
    ("hil", ["hil", "--scenario", "lane-change-on-belgian", "--strategy", "always-stiff"]),
    ("hil", ["hil", "--clock", "realtime", "--duration-s", "1"]),
    ("drive", ["drive", "--manoeuvre", "belgian", "--model", "both", "--duration-s", "2"]),
    ("drive", ["drive", "--manoeuvre", "straight", "--gas-temperature-c", "0", "--duration-s", "1"]),
    *(
        ("drive", ["drive", "--manoeuvre", name, "--setting", "baseline"])
        for name in ["lane-change", "constant-radius", "step-steer", "braking"]
    ),
    *(
        (f"rig-{name}", ["rig", name])
        for name in ["spring", "damping", "bulk-modulus", "valve-response", "replay", "limits"]
    ),
    ("drive", ["drive", "--manoeuvre", "step-steer", "--setting", "soft,stiff,controlled,baseline"]),
    ("study-sweep", ["study", "sweep", "--duration-s", "2"]),
    ("study-optimise", ["study", "optimise", "--iterations", "2", "--duration-s", "2", "--roll", "1"]),
    ("study-control", ["study", "control", "--quick", "--seeds", "1", "--duration-s", "5"]),
    ("study-robust", ["study", "robust", "--vehicles", "2"]),
    ("bench", ["bench", "--quick", "--repeats", "1"]),
    ("self-test", ["diagnose", "--self-test", "--campaigns", "2"]),
]


def errors(oleo, folder, schema, arguments, out):
    # Exit status 1 is a failed check, whose files are as good.
    run = subprocess.run([oleo, *arguments, "--out", out], cwd=folder, capture_output=True, text=True, check=False)
    if run.returncode > 1:
        return [run.stderr.strip()]
    return invalid(oleo, schema, folder / out)


def invalid(oleo, schema, out):
    shown = subprocess.run([oleo, "show", "schema", schema], check=True, capture_output=True, text=True).stdout
    validator = jsonschema.Draft202012Validator(json.loads(shown))
    validator.check_schema(validator.schema)
    name = "report.json" if schema == "diagnose" else "summary.json"
    found = json.loads((out / name).read_text(encoding="utf-8"))
    return [f"{error.json_path}: {error.message[:200]}" for error in validator.iter_errors(found)]


CORNERS = ["front-left", "front-right", "rear-left", "rear-right"]


def vehicle(oleo, folder):
    """A drive, and the files of its vehicle with too little gas at one corner; the command that diagnoses them."""
    drive = ["hil", "--duration-s", "20", "--road", "iso-d", "--speed-km-h", "20", "--record", "all", "--out", "run"]
    subprocess.run([oleo, *drive], cwd=folder, check=True, capture_output=True)
    files = folder / "vehicle"
    files.mkdir()
    named = "".join(f'{corner.replace("-", "_")} = "{corner}.toml"\n' for corner in CORNERS)
    text = f'[specimen]\nname = "car"\nkind = "vehicle"\n[strut]\n{named}'
    (files / "model.toml").write_text(text, encoding="utf-8")
    for corner in CORNERS:
        strut = (folder / "run" / corner / "model.toml").read_text(encoding="utf-8")
        if corner == "rear-left":
            assert "static_gas_volume_m3 = 0.0004" in strut
            strut = strut.replace("static_gas_volume_m3 = 0.0004", "static_gas_volume_m3 = 0.00036")
        (files / f"{corner}.toml").write_text(strut, encoding="utf-8")
    return ["diagnose", "run/candump.log", "--vehicle", "vehicle/model.toml"]


def main():
    oleo, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    failed = False
    commands = [*COMMANDS]
    saved = ["diagnose", "--self-test", "--save", "--campaigns", "1", "--terms", "sensor_gain", "--out", "campaigns"]
    subprocess.run([oleo, *saved], cwd=folder, check=True, capture_output=True)
    campaign = next(path.parent for path in (folder / "campaigns").glob("*/model.toml"))
    commands.append(("diagnose", ["diagnose", str(campaign.relative_to(folder))]))
    commands.append(("diagnose", vehicle(oleo, folder)))
    commands.append(("study-fleet", ["study", "fleet", "campaigns"]))
    # The first two commands are runs of hil, whose results lie in these folders.
    commands.append(("compare", ["compare", "out-0", "out-1", "--tolerance", "roll_rad=1%"]))
    for number, (schema, arguments) in enumerate(commands):
        for error in errors(oleo, folder, schema, arguments, f"out-{number}"):
            failed = True
            print(f"oleo {' '.join(arguments)}: {error}")
    print(f"{len(commands)} commands write what their schemas say" if not failed else "not as the schemas say")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
