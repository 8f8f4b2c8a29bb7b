"""Opens every kind of page in Chromium, at three widths, light and dark, and lists what a reader would stumble over.

    pages_in_browser.py OLEO CHROMIUM FOLDER

OLEO is the binary, FOLDER an empty folder in which the commands run. A page is judged by itself: a script at its end looks for errors of
other scripts, text that is cut off or leaves its drawing, axes without a title, figures and drawings without a name, and text too faint
to read. It reports to a page that shows it in three frames.
"""

import concurrent.futures
import functools
import http.server
import json
import pathlib
import queue
import subprocess
import sys
import tempfile
import threading

WIDTHS = (400, 1000, 1600)
# Chromium's number for the preferred colour scheme.
THEMES = {"dark": 0, "light": 1}
# Browsers at once: one draws a page in one process.
AT_ONCE = 2
# A browser that has not answered by then, or has ended, does not.
ANSWER_S = 300
# Contrast of text, by the Web Content Accessibility Guidelines 2.2, level AA.
CONTRAST = 4.5

# Page, arguments.
COMMANDS = {
    "hil": ["hil", "--scenario", "bus-silence", "--duration-s", "6"],
    "hil in a manoeuvre": ["hil", "--scenario", "step-steer"],
    "drive": ["drive", "--manoeuvre", "lane-change-2", "--driver", "hard", "--setting", "soft,stiff,controlled,baseline"],
    "drive with both models": ["drive", "--manoeuvre", "belgian", "--model", "both", "--duration-s", "3"],
    "rig spring": ["rig", "spring"],
    "rig damping": ["rig", "damping"],
    "rig valve-response": ["rig", "valve-response"],
    "study sweep": ["study", "sweep", "--duration-s", "2"],
    "study optimise": ["study", "optimise", "--duration-s", "2", "--iterations", "10", "--roll", "1", "--map"],
    "study control": ["study", "control", "--quick", "--seeds", "1", "--duration-s", "5"],
    "study robust": ["study", "robust", "--vehicles", "2"],
    "bench": ["bench", "--quick", "--repeats", "1"],
    "self-test": ["diagnose", "--self-test", "--campaigns", "2"],
}

# What runs in the head of a page: errors are collected from the first line on.
COLLECT = """<script>
const found = [];
addEventListener("error", (event) => found.push("error: " + event.message));
addEventListener("unhandledrejection", (event) => found.push("rejection: " + event.reason));
for (const level of ["error", "warn"]) console[level] = (...words) => found.push("console: " + words.join(" "));
</script>"""

# What runs at its end, when everything is drawn.
JUDGE = """<script>
(() => {
  const name = (node) => {
    const figure = node.closest("figure");
    const heading = figure && figure.querySelector("h3");
    return heading ? heading.textContent : figure && figure.getAttribute("aria-label");
  };
  const rgb = (colour) => (colour.match(/[\\d.]+/g) || []).map(Number);
  const luminance = ([r, g, b]) => {
    const part = (v) => { v /= 255; return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4; };
    return 0.2126 * part(r) + 0.7152 * part(g) + 0.0722 * part(b);
  };
  const contrast = (node, property = "color") => {
    let ground = node;
    while (ground && rgb(getComputedStyle(ground).backgroundColor)[3] === 0) ground = ground.parentElement;
    const at = [getComputedStyle(node)[property], ground ? getComputedStyle(ground).backgroundColor : "rgb(255, 255, 255)"];
    const [high, low] = at.map((colour) => luminance(rgb(colour))).sort((a, b) => b - a);
    return (high + 0.05) / (low + 0.05);
  };
  const seen = (node) => node.getClientRects().length > 0;
  const sleep = (ms) => new Promise((done) => setTimeout(done, ms));
  const judgeText = () => {
    const page = document.documentElement;
    if (page.scrollWidth > innerWidth + 1) found.push(`the page is ${page.scrollWidth} px wide`);
    if (!document.title || !document.querySelector("h1").textContent) found.push("no title");
    for (const node of document.querySelectorAll("h1, h2, h3, p, td, th, dt, dd, .verdict, figcaption, summary, label, button")) {
      if (!seen(node) || !node.textContent.trim()) continue;
      const inside = node.closest(".scroll, pre");
      if (!inside && node.scrollWidth > node.clientWidth + 1 && node.clientWidth > 0 && getComputedStyle(node).display !== "inline")
        found.push(`cut off: ${node.textContent.slice(0, 60)}`);
      if (contrast(node) < CONTRAST) found.push(`faint, ${contrast(node).toFixed(1)}: ${node.textContent.slice(0, 60)}`);
    }
    for (const figure of document.querySelectorAll("figure"))
      if (seen(figure) && !name(figure) && !figure.querySelector("svg[aria-label], svg > title")) found.push("a figure without a name");
  };
  const judgeCharts = () => {
    for (const chart of document.querySelectorAll(".chart")) {
      if (!seen(chart)) continue;
      const plot = chart.querySelector("svg.main-svg");
      if (!plot) { found.push(`not drawn: ${name(chart)}`); continue; }
      const frame = plot.getBoundingClientRect();
      // An axis whose ticks are names says what it is by them.
      for (const axis of Object.keys(chart.layout).filter((key) => /^[xy]axis\\d*$/.test(key))) {
        const letter = axis.replace("axis", ""), ticks = chart.querySelectorAll(`.${letter}tick text`);
        const named = [...ticks].some((tick) => /[a-z]{2}/i.test(tick.textContent));
        const title = chart.layout[axis].title;
        if (!named && !(title && title.text)) found.push(`${axis} without a title: ${name(chart)}`);
      }
      for (const text of chart.querySelectorAll(".xtick text, .ytick text, .xtitle, .ytitle, .legendtext"))
        if (seen(text) && contrast(text, "fill") < CONTRAST) found.push(`faint, ${contrast(text, "fill").toFixed(1)}: "${text.textContent}" in ${name(chart)}`);
      for (const text of chart.querySelectorAll("svg text")) {
        const box = text.getBoundingClientRect();
        if (box.width === 0 || !text.textContent.trim() || text.closest(".hoverlayer, .modebar, .scrollbox")) continue;
        if (box.left < frame.left - 2 || box.right > frame.right + 2 || box.top < frame.top - 2 || box.bottom > frame.bottom + 2)
          found.push(`outside of its drawing: "${text.textContent}" in ${name(chart)}`);
      }
    }
  };
  // A busy machine draws late. What is never drawn is complained of.
  const drawn = async () => {
    const missing = () => [...document.querySelectorAll(".chart")].some((chart) => seen(chart) && !chart.querySelector("svg.main-svg"));
    for (let waited = 0; missing() && waited < 30000; waited += 100) await sleep(100);
    await sleep(150);
  };
  // What is behind a line to click, and each figure that can be chosen, is looked at too.
  const judge = async () => {
    await drawn();
    document.querySelectorAll("details").forEach((details) => { details.open = true; });
    judgeText();
    judgeCharts();
    for (const choice of document.querySelectorAll("input[type=radio]:not(:checked)")) {
      choice.click();
      await drawn();
      judgeCharts();
    }
    parent.postMessage({ found: [...new Set(found)], charts: document.querySelectorAll(".chart.drawn").length }, "*");
  };
  addEventListener("load", judge);
})();
</script>"""

FRAMES = """<!doctype html><body><script>
const answers = {};
addEventListener("message", (event) => {
  const frame = [...document.querySelectorAll("iframe")].find((frame) => frame.contentWindow === event.source);
  answers[frame.width] = event.data;
  if (Object.keys(answers).length === 3) fetch("answers", { method: "POST", body: JSON.stringify(answers) });
});
</script>FRAMES</body>"""


class Server(http.server.SimpleHTTPRequestHandler):
    """Serves a folder, and takes what a page sends."""

    answers: queue.Queue

    def do_POST(self):
        self.answers.put(json.loads(self.rfile.read(int(self.headers["Content-Length"]))))
        self.send_response(204)
        self.end_headers()

    def log_message(self, *_):
        pass


def judged(chromium, page, theme):
    """What is wrong with a page, and how many charts it shows, by width. A browser that a signal ends has judged nothing: it is asked once more."""
    answer, status = asked(chromium, page, theme)
    if status is not None and status < 0:
        print(f"{page.parent.name}: Chromium was ended by signal {-status} and is asked once more")
        answer, _ = asked(chromium, page, theme)
    return answer


def asked(chromium, page, theme):
    """What a browser says of a page, by width, and its status if it ended without an answer."""
    # The browser's children may still write when it has ended.
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name:
        folder = pathlib.Path(name)
        text = page.read_text(encoding="utf-8").replace("<head>", "<head>" + COLLECT, 1)
        judge = JUDGE.replace("CONTRAST", str(CONTRAST))
        (folder / "page.html").write_text(text.replace("</body>", judge + "</body>", 1), encoding="utf-8")
        frames = "".join(f'<iframe src="page.html" width="{width}" height="1200"></iframe>' for width in WIDTHS)
        (folder / "frames.html").write_text(FRAMES.replace("FRAMES", frames), encoding="utf-8")
        answers = queue.Queue()
        handler = type("Handler", (Server,), {"answers": answers})
        with http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(handler, directory=name)) as server:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            said = folder / "said"
            browser = subprocess.Popen(
                [
                    chromium, "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
                    "--disable-background-networking", "--disable-component-update", "--disable-sync",
                    f"--blink-settings=preferredColorScheme={theme}", f"--user-data-dir={folder / 'profile'}",
                    "--window-size=1700,1300", "--remote-debugging-port=0", f"http://127.0.0.1:{server.server_port}/frames.html",
                ],
                stdout=subprocess.DEVNULL, stderr=said.open("wb"),
            )  # fmt: skip
            try:
                for _ in range(ANSWER_S):
                    try:
                        return answers.get(timeout=1), None
                    except queue.Empty:
                        if browser.poll() is not None:
                            break
                end, status = said.read_text(errors="replace").strip()[-300:], browser.poll()
                return {0: {"found": [f"Chromium gave no answer (status {status}): {end}"], "charts": 0}}, status
            finally:
                browser.terminate()
                browser.wait()
                server.shutdown()


# What is put into a page that has nothing wrong, and the complaint that must follow.
PLANTED = [
    ("</main>", '<p style="color: #777; background: #888">faint</p></main>', "faint"),
    ("</main>", '<h2 style="width: 40px; white-space: nowrap; overflow: hidden">a heading without room</h2></main>', "cut off: a heading"),
    ("</main>", "<figure><svg></svg></figure></main>", "a figure without a name"),
    ("</main>", '<div style="width: 3000px">wide</div></main>', "px wide"),
    ("</main>", '<script>console.error("said")</script></main>', "console: said"),
    ('"title":{"text":"Roll, degrees"}', '"title":{"text":""}', "without a title: Motion of the body"),
    ('"text":"Pitch, degrees"', '"text":"Pitch, degrees' + ", and so on" * 30 + '"', "outside of its drawing"),
]


def unseen(chromium, page):
    """The planted mistakes that are not complained of. A check that cannot fail proves nothing."""
    text, wrong = page.read_text(encoding="utf-8"), []
    for place, mistake, _ in PLANTED:
        if place not in text:
            wrong.append(f"planted: the page has no {place}")
        text = text.replace(place, mistake, 1)
    planted = page.with_name("planted.html")
    planted.write_text(text, encoding="utf-8")
    found = [what for answer in judged(chromium, planted, THEMES["light"]).values() for what in answer["found"]]
    complaints = [complaint for *_, complaint in PLANTED]
    return wrong + [f"planted and not found: {c}" for c in complaints if not any(c in what for what in found)]


def pages(oleo, folder):
    """The page of each command."""
    commands = dict(COMMANDS)
    saved = ["diagnose", "--self-test", "--save", "--campaigns", "1", "--terms", "seal_friction", "--out", "campaigns"]
    subprocess.run([oleo, *saved], cwd=folder, check=True, capture_output=True)
    campaign = next(path.parent for path in (folder / "campaigns").glob("*/model.toml"))
    commands["diagnose"] = ["diagnose", str(campaign.relative_to(folder))]
    commands["study fleet"] = ["study", "fleet", "campaigns"]
    commands["compare"] = ["compare", "drive", "--tolerance", "max_roll_deg=5%"]
    for name, arguments in commands.items():
        out = name.replace(" ", "-")
        run = subprocess.run([oleo, *arguments, "--out", out], cwd=folder, capture_output=True, text=True, check=False)
        if run.returncode > 1:
            sys.exit(f"oleo {' '.join(arguments)}: {run.stderr.strip()}")
        yield name, folder / out / "report.html"


def main():
    oleo, chromium, folder = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2], pathlib.Path(sys.argv[3])
    wrong, charts, answers = [], 0, []
    with concurrent.futures.ThreadPoolExecutor(AT_ONCE) as browsers:
        for name, page in pages(oleo, folder):
            answers += [(name, theme, browsers.submit(judged, chromium, page, number)) for theme, number in THEMES.items()]
            if name == "drive":
                missed = browsers.submit(unseen, chromium, page)
        for name, theme, answer in answers:
            for width, seen in answer.result().items():
                charts += seen["charts"]
                wrong += [f"{name}, {theme}, {width} px: {what}" for what in seen["found"]]
        wrong += missed.result()
    count = len(answers) // len(THEMES)
    print("\n".join(wrong))
    print(f"{count} pages at {len(WIDTHS)} widths in 2 themes, {charts} charts drawn, {len(wrong)} complaints; {len(PLANTED)} were planted")
    sys.exit(1 if wrong or charts == 0 else 0)


if __name__ == "__main__":
    main()
