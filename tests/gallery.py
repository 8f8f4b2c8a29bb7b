"""Diagnoses every campaign of the recordings and draws one picture a case: as believed, as recorded, and as found.

    gallery.py OLEO RECORDINGS FOLDER DOCS

OLEO is the binary, RECORDINGS the folder with `labelled`, `blind` and `real`. FOLDER keeps what each diagnosis writes; a case that has its
report there is not diagnosed again. DOCS gets `gallery.md` and its pictures.
"""

import csv
import io
import json
import pathlib
import subprocess
import sys
import tomllib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from PIL import Image  # noqa: E402

# What of the measured recordings is not fitted, so that the picture can show it.
UNSEEN = {
    "gas-spring": ["--fit-until", "0.5"],
    "drive": ["--fit-until", "0.5"],
    "ram": ["--fit-until", "0.5"],
    "pneumatic": ["--hold-out", "5bar"],
    "damper": ["--hold-out", "5mm3Hz"],
}
# A picture shows an eighth of a recording, but no less and no more than this, s.
STRETCH_S = (2.0, 60.0)
UNITS = {"N": ("N", 1.0), "Pa": ("MPa", 1e-6), "m": ("mm", 1e3)}

HEAD = """# Gallery

*For readers who want to see what `oleo diagnose` does, case by case.*

    ./test gallery

makes this page and its pictures. Each case is one campaign of recordings with a model that lacks something. A picture shows the channel and the stretch of a recording that the believed
model misses most: in its upper part the recording, the model as believed and the model as found; in its lower part the recording minus each model, in units of the sensor's noise, where
a complete model leaves a band of about two. The figures below it are RMS values over the whole of that recording. *Not fitted* means that the recording, or its second half, was not given to the fit.
"""

PARTS = {
    "labelled": """
## Simulated struts whose answer is known

An independent simulator made these campaigns. The picture shows one of five further recordings of the same strut that were not fitted.
""",
    "blind": """
## Simulated struts whose answer is sealed

What was concealed in these campaigns is not known here. The picture shows a recording of the campaign, which was fitted.
""",
    "real": """
## Measured hardware

[results.md](results.md#real-hardware) states the sources' figures and what remains unexplained. Recordings are not part of this repository; their sources are named in the README beside them.
""",
}


def arguments_for(kind, name):
    """What of a campaign is held out, as options of the command line."""
    if kind != "real":
        return []
    return next(arguments for start, arguments in UNSEEN.items() if name.startswith(start))


def diagnosed(oleo, campaign, arguments, out):
    """The report of a campaign, made unless it is there."""
    if not (out / "report.json").is_file():
        subprocess.run([oleo, "diagnose", campaign, "--out", out, *arguments], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return json.loads((out / "report.json").read_text())


def columns_of(path):
    """The columns of a recording, by name."""
    with path.open(newline="") as file:
        rows = csv.reader(file)
        names = next(rows)
        values = np.array([[float(value) for value in row] for row in rows])
    return dict(zip(names, values.T))


def predicted(oleo, model, recording, folder):
    """What a model predicts of a recording; the file stays in the folder."""
    out = folder / f"{recording.stem}.csv"
    folder.mkdir(exist_ok=True)
    subprocess.run([oleo, "predict", "--model", model, recording, "--out", out, "--force"], check=True, stdout=subprocess.DEVNULL)
    return columns_of(out)


class Case:
    """One recording of a campaign with both models, and the channel that the believed one misses most."""

    def __init__(self, oleo, campaign, recording, out, first_half):
        self.measured = columns_of(recording)
        self.name = recording.stem
        believed = predicted(oleo, campaign / "model.toml", recording, out / "believed")
        found = predicted(oleo, out / "model.toml", recording, out / "found")
        noise = tomllib.loads((campaign / "model.toml").read_text())["noise"]
        time = self.measured["time_s"]
        judged = time >= time[0] + first_half * (time[-1] - time[0])
        self.residuals = {}
        for channel, sigma in noise.items():
            if channel in believed and sigma > 0 and not np.array_equal(believed[channel], self.measured[channel]):
                both = [(self.measured[channel] - model[channel]) / sigma for model in (believed, found)]
                self.residuals[channel] = [np.where(judged, residual, np.nan) for residual in both]
        ratio = lambda residual: float(np.sqrt(np.nanmean(residual**2)))
        self.ratios = {channel: [ratio(residual) for residual in both] for channel, both in self.residuals.items()}
        self.channel = max(self.ratios, key=lambda channel: self.ratios[channel][0])
        self.series = [self.measured[self.channel], believed[self.channel], found[self.channel]]

    def stretch(self):
        """The samples in which the believed model is farthest from the recording."""
        time, miss = self.measured["time_s"], np.nan_to_num(self.residuals[self.channel][0] ** 2)
        least, most = STRETCH_S
        seconds = min(max((time[-1] - time[0]) / 8, least), most, time[-1] - time[0])
        width = int(np.searchsorted(time, time[0] + seconds))
        sums = np.convolve(miss, np.ones(width), "valid")
        begin = int(np.argmax(sums))
        return slice(begin, begin + width)

    def draw(self, path):
        """Writes the picture."""
        quantity, _, unit = self.channel.rpartition("_")
        shown_unit, scale = UNITS[unit]
        part = self.stretch()
        time = self.measured["time_s"][part]
        figure, (above, below) = plt.subplots(2, 1, figsize=(5.4, 3.3), sharex=True, height_ratios=(3, 2), layout="constrained")
        looks = (("recorded", "#9a9a9a", 2.6), ("as believed", "#d55e00", 1.0), ("as found", "#0072b2", 1.0))
        for values, (label, colour, width) in zip(self.series, looks):
            above.plot(time, values[part] * scale, color=colour, linewidth=width, label=label)
        above.set_ylabel(f"{quantity}, {shown_unit}")
        above.legend(loc="upper center", bbox_to_anchor=(0.5, 1.22), ncols=3, frameon=False, fontsize=8)
        for residual, (_, colour, _) in zip(self.residuals[self.channel], looks[1:]):
            below.plot(time, residual[part], color=colour, linewidth=0.7)
        below.set_ylabel("misfit, x noise")
        below.set_xlabel(f"time in {self.name}, s")
        for axes in (above, below):
            axes.tick_params(labelsize=8)
            axes.spines[["top", "right"]].set_visible(False)
        drawn = io.BytesIO()
        figure.savefig(drawn, dpi=90)
        plt.close(figure)
        # Few colours: a third of the size.
        Image.open(drawn).convert("RGB").quantize(48).save(path, optimize=True)


def worst(cases):
    """The recording whose misfit is explained most, by the ratio of its worst channel."""
    return max(cases, key=lambda case: case.ratios[case.channel][0])


def found_text(report):
    """The effects of a report in words, with their parameters and intervals."""
    lines = []
    for effect in report["effects"]:
        numbers = [
            f"{name} {value['value']:.4g} [{value['ci95'][0]:.4g}, {value['ci95'][1]:.4g}]" if value.get("ci95") else f"{name} {value['value']:.4g}"
            for name, value in effect["parameters"].items()
        ]
        text = f"`{effect['id']}` at `{effect['place']}`"
        lines.append(text + (f" ({'; '.join(numbers)})" if numbers else "") + f", confidence {effect['confidence']:.2f}")
    return "; ".join(lines) or "nothing is missing"


def concealed_text(kind, answers, name):
    """What is known of a case."""
    if kind != "labelled":
        return None
    answer = json.loads((answers / name / "answer.json").read_text())
    numbers = [f"{key} {value:.4g}" for truth in answer["truth"].values() for key, value in truth.items() if not key.startswith("_")]
    return (", ".join(f"`{effect}`" for effect in answer["hidden"]) or "nothing") + (f" ({'; '.join(numbers)})" if numbers else "")


def main():
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    oleo, recordings, folder, docs = sys.argv[1], *map(pathlib.Path, sys.argv[2:])
    pictures = docs / "images" / "gallery"
    pictures.mkdir(parents=True, exist_ok=True)
    text = [HEAD]
    for kind, introduction in PARTS.items():
        text.append(introduction)
        for campaign in sorted(path for path in (recordings / kind).iterdir() if path.is_dir()):
            name, arguments = campaign.name, arguments_for(kind, campaign.name)
            out = folder / name
            report = diagnosed(oleo, campaign, arguments, out)
            answers = recordings / "labelled-answers"
            shown = sorted((answers / name).glob("val_*.csv") if kind == "labelled" else campaign.glob("*.csv"))
            if "--hold-out" in arguments:
                shown = [campaign / f"{arguments[1]}.csv"]
            half = float(arguments[1]) if "--fit-until" in arguments else 0.0
            case = worst([Case(oleo, campaign, recording, out, half) for recording in shown])
            case.draw(pictures / f"{name}.png")
            before, after = case.ratios[case.channel]
            unseen = "fitted" if kind == "blind" else "second half, not fitted" if half else "not fitted"
            concealed = concealed_text(kind, answers, name)
            text.append(f"\n### {name}\n\n")
            text.append(f"![{name}: {case.channel} of {case.name}, recorded, as believed and as found](images/gallery/{name}.png)\n\n")
            if concealed:
                text.append(f"- Concealed: {concealed}.\n")
            text.append(f"- Found: {found_text(report)}.\n")
            text.append(f"- `{case.channel}` of `{case.name}` ({unseen}): {before:.3g} times the noise as believed, {after:.3g} times as found.\n")
            print(f"{name}: {before:.3g} -> {after:.3g}", flush=True)
    (docs / "gallery.md").write_text("".join(text))


if __name__ == "__main__":
    main()
