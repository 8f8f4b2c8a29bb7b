#!/usr/bin/env python3
"""Mutation test of the controller: which changes of its code does no test notice?

    mutants.py [--files REGEX] [--tree DIR] [--report FILE] [--again FILE]

`cargo mutants --list` says which changes there are. Building the tests anew for each of nearly two thousand takes hours, so
all are built at once: each changed place in a copy of the checkout becomes `if on(NUMBER) { changed } else { as it was }`, and the
environment chooses the number at run time. A first run of each test program notes which places it reaches; each mutant is
then run by the programs that reach it, the unit tests first, until one fails. An operator is replaced where it stands in the syntax
tree: its operands stay what they are, also where the changed text would be read with another precedence.

Not switched, and therefore not run: places that the compiler evaluates (`const`), and changes that do not compile.

Survivors are compared with tests/harness/mutants.txt, which says of each why it may survive. A survivor that is not in that
file is an error, and so is a line in it that is not needed any more.
"""

import argparse
import concurrent.futures
import json
import os
import re
import subprocess
import sys
import time
from collections import Counter, defaultdict
from pathlib import Path

import tree_sitter
import tree_sitter_rust

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = "oleo-controller"
SOURCES = "controller/src"
EXPLAINED = ROOT / "tests/harness/mutants.txt"
# Test programs in the order in which they are tried: quick ones first. The golden commands and the pages of the API are left out:
# they notice any change and say nothing about whether it is right.
PROGRAMS = ["oleo_controller", "end_to_end_protection", "can_database", "estimate", "spring_switching", "faults", "attacks", "fault_plans", "recovery"]

SWITCH = """//! Which mutant is active. Made by tests/harness/mutants.py.
extern crate std;
use core::sync::atomic::{AtomicBool, Ordering};
use std::io::Write as _;
use std::sync::OnceLock;

static ACTIVE: OnceLock<(usize, Option<std::string::String>)> = OnceLock::new();
static REACHED: [AtomicBool; COUNT] = [const { AtomicBool::new(false) }; COUNT];

/// Whether a mutant is active.
pub fn on(number: usize) -> bool {
    let (active, trace) = ACTIVE.get_or_init(|| {
        let number = |text: std::string::String| text.parse().ok();
        (std::env::var("OLEO_MUTANT").ok().and_then(number).unwrap_or(usize::MAX), std::env::var("OLEO_MUTANTS_REACHED").ok())
    });
    if let Some(file) = trace && !REACHED[number].swap(true, Ordering::Relaxed) {
        let mut file = std::fs::OpenOptions::new().create(true).append(true).open(file).expect("a file for the trace");
        file.write_all(std::format!("{number}\\n").as_bytes()).expect("room for the trace");
    }
    number == *active
}
"""


def mutants_of(tree, files):
    """All mutants that cargo-mutants knows, with a key that does not depend on line numbers."""
    command = ["cargo", "mutants", "--list", "--json", "--diff", "-p", PACKAGE]
    listed = json.loads(subprocess.run(command, cwd=tree, check=True, capture_output=True, text=True).stdout)
    listed.sort(key=lambda m: (m["file"], m["span"]["start"]["line"], m["span"]["start"]["column"]))
    seen = Counter()
    chosen = []
    for mutant in listed:
        # "file:line:column: what" becomes "file: what", and the second of the same "file: what #2".
        what = re.sub(r":\d+:\d+: ", ": ", mutant["name"])
        seen[what] += 1
        mutant["key"] = what if seen[what] == 1 else f"{what} #{seen[what]}"
        if re.search(files, mutant["file"]):
            chosen.append(mutant)
    return chosen


def parser():
    return tree_sitter.Parser(tree_sitter.Language(tree_sitter_rust.language()))


class Source:
    """A source file, its syntax tree, and its mutants."""

    def __init__(self, path, mutants):
        self.text = path.read_bytes()
        self.tree = parser().parse(self.text)
        self.lines = [0]
        for line in self.text.splitlines(keepends=True):
            self.lines.append(self.lines[-1] + len(line))
        self.at = defaultdict(list)  # id of a node: its mutants
        self.unswitched = []
        for mutant in mutants:
            node = self.place(mutant)
            if node is None or self.is_constant(node):
                self.unswitched.append(mutant)
            else:
                self.at[node.id].append(mutant)

    def offset(self, position):
        line = self.text[self.lines[position["line"] - 1] :].split(b"\n", 1)[0].decode()
        return self.lines[position["line"] - 1] + len(line[: position["column"] - 1].encode())

    def source(self, node):
        return self.text[node.start_byte : node.end_byte].decode()

    def place(self, mutant):
        """The node that is to be switched."""
        start, end = self.offset(mutant["span"]["start"]), self.offset(mutant["span"]["end"])
        node = self.tree.root_node.descendant_for_byte_range(start, max(start, end - 1))
        wanted = {
            "BinaryOperator": ("binary_expression", "compound_assignment_expr"),
            "UnaryOperator": ("unary_expression",),
            "FnValue": ("function_item",),
            "MatchArm": ("match_arm",),
            "MatchArmGuard": ("match_arm",),
            "StructField": ("struct_expression",),
        }[mutant["genre"]]
        while node is not None and node.type not in wanted:
            node = node.parent
        return node

    def is_constant(self, node):
        while node is not None:
            if node.type in ("const_item", "static_item", "const_block", "array_type", "macro_invocation", "enum_variant"):
                return True
            if node.type == "function_item":
                modifiers = [child for child in node.children if child.type == "function_modifiers"]
                return any("const" in self.source(child).split() for child in modifiers)
            node = node.parent
        return False

    def mutated(self, node, mutant):
        """The text of a node as a mutant has it."""
        start, end = self.offset(mutant["span"]["start"]), self.offset(mutant["span"]["end"])
        after = self.text[end : node.end_byte].decode()
        if mutant["genre"] == "StructField":
            after = after.lstrip().removeprefix(",")
        return self.text[node.start_byte : start].decode() + f" {mutant['replacement']} " + after

    def rewritten(self, node, skip):
        """The text of a node in which every mutant has its switch."""
        mutants = [m for m in self.at.get(node.id, []) if m["number"] not in skip]
        body = node.child_by_field_name("body") if node.type == "function_item" else None
        pattern = node.child_by_field_name("pattern") if node.type == "match_arm" else None
        parts, at = [], node.start_byte
        for child in node.children:
            parts.append(self.text[at : child.start_byte].decode())
            if mutants and child == pattern:
                parts.append(self.pattern(child, mutants, skip))
            else:
                parts.append(self.rewritten(child, skip))
            if mutants and body is not None and child == body:
                switches = "".join(
                    f"if crate::mutants::on({m['number']}) {{ return /*<{m['number']}*/ {m['replacement']} /*{m['number']}>*/; }} "
                    for m in mutants
                )
                parts[-1] = "{ " + switches + parts[-1][1:]
            at = child.end_byte
        parts.append(self.text[at : node.end_byte].decode())
        text = "".join(parts)
        if not mutants or body is not None or pattern is not None:
            return text
        for m in mutants:
            changed = f"/*<{m['number']}*/ {self.mutated(node, m)} /*{m['number']}>*/"
            text = f"if crate::mutants::on({m['number']}) {{ {changed} }} else {{ {text} }}"
        return f"({text})"

    def pattern(self, node, mutants, skip):
        """The pattern of a match arm that can be absent, or whose guard can be always or never true."""
        guard = node.child_by_field_name("condition")
        text = self.source(node) if guard is None else self.text[node.start_byte : guard.start_byte].decode().rsplit("if", 1)[0]
        condition = "true" if guard is None else self.rewritten(guard, skip)
        for m in mutants:
            value = "false" if m["genre"] == "MatchArm" else m["replacement"]
            condition = f"(if crate::mutants::on({m['number']}) {{ {value} }} else {{ {condition} }})"
        return f"{text} if {condition}"

    def write(self, path, skip):
        path.write_text(self.rewritten(self.tree.root_node, skip))


def build(tree, sources, mutants):
    """Builds the test programs; returns the mutants that do not compile, and the programs."""
    skip = set()
    arms = {mutant["number"] for mutant in mutants if mutant["genre"] == "MatchArm"}
    # With every feature, or what they add would survive for want of a test that runs.
    package = ["-p", PACKAGE, "--all-features"]
    command = ["cargo", "test", "--no-run", *package, "--lib", "--tests", "--message-format=json"]
    check = ["cargo", "check", *package, "--lib", "--message-format=json"]
    while True:
        for path, source in sources.items():
            source.write(tree / path, skip)
        done = subprocess.run(check, cwd=tree, capture_output=True, text=True)
        found = set()
        rest = []
        for line in done.stdout.splitlines():
            message = json.loads(line).get("message") or {}
            if message.get("level") != "error" or not message.get("spans"):
                continue
            mine = {number for span in message["spans"] for number in blamed(tree, span)}
            if (message.get("code") or {}).get("code") == "E0004":
                mine |= {number for span in message["spans"] for number in arms_of(tree, span)} & arms
            found |= mine
            if not mine:
                rest.append(message["rendered"])
        if done.returncode == 0:
            break
        if not found - skip:
            sys.exit("no mutant is to blame for:\n" + "\n".join(rest[:5]) + done.stderr[-2000:])
        skip |= found
        print(f"   {len(skip)} do not compile", flush=True)
    done = subprocess.run(command, cwd=tree, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(done.stderr[-6000:])
    programs = {}
    for line in done.stdout.splitlines():
        message = json.loads(line)
        if message.get("executable") and message["profile"]["test"]:
            programs[message["target"]["name"]] = message["executable"]
    return skip, {name: programs[name] for name in PROGRAMS}


def blamed(tree, span):
    """The mutants whose changed text contains a place in the rewritten source."""
    path = tree / span["file_name"]
    if not path.is_file():
        return
    text = path.read_bytes()
    inside = text[: span["byte_start"]]
    opened = [int(n) for n in re.findall(rb"/\*<(\d+)\*/", inside)]
    closed = {int(n) for n in re.findall(rb"/\*(\d+)>\*/", inside)}
    for number in reversed(opened):
        if number not in closed:
            yield number
            return


def arms_of(tree, span):
    """The numbers in the match whose arms are not all there is: without one of them it does not compile."""
    path = tree / span["file_name"]
    if not path.is_file():
        return set()
    text = path.read_bytes()
    node = parser().parse(text).root_node.descendant_for_byte_range(span["byte_start"], span["byte_end"] - 1)
    while node is not None and node.type != "match_expression":
        node = node.parent
    return set() if node is None else set(map(int, re.findall(rb"mutants::on\((\d+)\)", text[node.start_byte : node.end_byte])))


def run(tree, program, environment, limit_s, only=()):
    """Whether a test program, or the part of it with a name, passes within a time."""
    # A failure needs neither a backtrace nor the smallest case.
    quiet = {"RUST_BACKTRACE": "0", "PROPTEST_MAX_SHRINK_ITERS": "0"}
    environment = {**os.environ, **quiet, "PROPTEST_RNG_SEED": "2002", "CARGO_MANIFEST_DIR": str(tree / "controller"), **environment}
    try:
        done = subprocess.run(
            [program, "-q", *only], cwd=tree / "controller", env=environment, timeout=limit_s,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL,
        )
    except subprocess.TimeoutExpired:
        return None
    return done.returncode == 0


def passes(tree, name, program, mutant, limit_s):
    """Whether a test program passes with a mutant. The unit tests of the mutant's own file are tried first: they are quick."""
    environment = {"OLEO_MUTANT": str(mutant["number"])}
    if name == "oleo_controller":
        module = mutant["file"].removeprefix(f"{SOURCES}/").removesuffix(".rs").removesuffix("/mod").replace("/", "::")
        passed = run(tree, program, environment, limit_s, only=[f"{module}::"])
        if not passed:
            return passed
    return run(tree, program, environment, limit_s)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--files", default="", help="only the sources whose path contains this regular expression")
    parser.add_argument("--tree", type=Path, default=ROOT / "target/mutants", help="where the changed copy is built")
    parser.add_argument("--report", type=Path, help="a file for the outcome of each mutant, tab separated")
    parser.add_argument("--again", type=Path, help="a report: only what survived in it or is not in it is run")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--programs", default="", help="only these test programs, comma separated")
    arguments = parser.parse_args()
    tree = arguments.tree.resolve()

    files = subprocess.run(["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT, check=True, capture_output=True, text=True)
    for name in filter(None, files.stdout.split("\0")):
        if (ROOT / name).is_file():
            copy(ROOT / name, tree / name)
    mutants = mutants_of(tree, arguments.files)
    for number, mutant in enumerate(mutants):
        mutant["number"] = number
    by_file = defaultdict(list)
    for mutant in mutants:
        by_file[mutant["file"]].append(mutant)
    sources = {path: Source(tree / path, of_file) for path, of_file in by_file.items()}
    (tree / SOURCES / "mutants.rs").write_text(SWITCH.replace("COUNT", str(len(mutants))))
    library = tree / SOURCES / "lib.rs"
    text = library.read_text().replace("mod configuration;", "pub mod mutants;\nmod configuration;", 1)
    # A changed constant that the compiler knows to overflow fails when it runs, as it should.
    text = text.replace("#![no_std]", "#![no_std]\n#![allow(arithmetic_overflow, unconditional_panic)]", 1)
    library.write_text(text)
    print(f"   {len(mutants)} mutants", flush=True)
    uncompiled, programs = build(tree, sources, mutants)
    if arguments.programs:
        programs = {name: programs[name] for name in arguments.programs.split(",")}

    outcome = {}
    if arguments.again:
        before = {key: said for said, key, _ in (line.split("\t") for line in arguments.again.read_text().splitlines())}
        outcome.update({m["number"]: before[m["key"]] for m in mutants if before.get(m["key"], "survived") != "survived"})
    for source in sources.values():
        outcome.update({mutant["number"]: "not switched" for mutant in source.unswitched})
    outcome.update({number: "does not compile" for number in uncompiled})

    left = [m["number"] for m in mutants if m["number"] not in outcome]
    for name, program in programs.items():
        reached_file = tree / "reached.txt"
        reached_file.unlink(missing_ok=True)
        began = time.monotonic()
        if not run(tree, program, {"OLEO_MUTANTS_REACHED": str(reached_file)}, 900):
            sys.exit(f"{name} does not pass without a mutant")
        limit_s = 5 + 10 * (time.monotonic() - began)
        reached = set(map(int, reached_file.read_text().split())) if reached_file.exists() else set()
        mine = [number for number in left if number in reached]
        with concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
            passed_all = pool.map(lambda number: passes(tree, name, program, mutants[number], limit_s), mine)
            for done, (number, passed) in enumerate(zip(mine, passed_all)):
                if done % 100 == 99:
                    print(f"   {name}: {done + 1} of {len(mine)} run after {time.monotonic() - began:.0f} s", flush=True)
                if not passed:
                    outcome[number] = f"caught by {name}" if passed is False else f"timeout in {name}"
        left = [number for number in left if number not in outcome]
        print(f"   {name}: {len(mine)} run, {len(left)} left, {time.monotonic() - began:.0f} s", flush=True)
        if arguments.report:
            write_report(mutants, {**{number: "survived" for number in left}, **outcome}, arguments.report)
    outcome.update({number: "survived" for number in left})
    sys.exit(report(mutants, outcome, arguments))


def copy(source, target):
    """Copies a file if it has changed, so that cargo builds no more than it must."""
    content = source.read_bytes()
    if not target.exists() or target.read_bytes() != content:
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)


def write_report(mutants, outcome, path):
    path.write_text("".join(f"{outcome[m['number']]}\t{m['key']}\t{m['name']}\n" for m in mutants))


def report(mutants, outcome, arguments):
    """Prints a table and compares the survivors with those that are explained; returns the exit status."""
    kinds = ["caught", "survived", "does not compile", "not switched"]
    table = defaultdict(Counter)
    for mutant in mutants:
        kind = outcome[mutant["number"]]
        kind = "caught" if kind.startswith(("caught", "timeout")) else kind
        for row in (mutant["file"].removeprefix(f"{SOURCES}/"), "all"):
            table[row][kind] += 1
    print(f"   {'file':<34}{'found':>8}" + "".join(f"{kind:>18}" for kind in kinds))
    for row in sorted(table, key=lambda row: (row == "all", row)):
        print(f"   {row:<34}{sum(table[row].values()):>8}" + "".join(f"{table[row][kind]:>18}" for kind in kinds))
    explained = {}
    for line in EXPLAINED.read_text().splitlines() if EXPLAINED.exists() else []:
        if line and not line.startswith("#"):
            key, _, reason = line.rpartition(" | ")  # a change may contain " | "
            explained[key] = reason
    survived = {m["key"]: m["name"] for m in mutants if outcome[m["number"]] == "survived"}
    known = {m["key"] for m in mutants}
    new = [name for key, name in survived.items() if key not in explained]
    stale = [key for key in explained if key not in survived and (key in known or not arguments.files)]
    for name in new:
        print(f"survived without an explanation: {name}")
    for key in stale:
        print(f"explained, but does not survive (or does not exist): {key}")
    return 1 if new or stale else 0


if __name__ == "__main__":
    main()
