"""No cycle between modules, and no dependency of a crate that points up: `modules.py [ROOT]`.

A module depends on another where its code, tests left out, names something that is defined there: by `use`, or by a path in
the text. A re-export (`pub use`) is a second name and no dependency; what is reached through it counts for the module that
defines it. Two things are required of every module that has submodules:

    its submodules, each taken with all that is below it, do not depend on each other in a circle, and
    its own code is not part of such a circle: where it uses a submodule, that submodule does not use it.

Between crates the order is the table ORDER below: a crate may depend on crates of an earlier line only.

Why not `cargo modules dependencies --acyclic`: it calls every type with a method a cycle (the type owns the method, the method
names the type), stops at the first, and takes half an hour to install. This reads the text and needs Python alone.

Exit status 1 where something is found, with the places that make the circle.
"""

import collections
import pathlib
import re
import sys
import tomllib

# What may depend on what: a crate on crates of earlier lines.
ORDER = [
    {"oleo-interface"},
    {"oleo-controller", "oleo-plant-sim", "oleo-report"},
    {"oleo-xcp"},
    {"oleo-hil", "oleo-diagnose", "oleo-firmware", "oleo-bench", "oleo-fmu-import", "oleo-solvers"},
    {"oleo-fmu"},
    {"oleo", "oleo-fuzz", "oleo-python"},
]

TOKEN = re.compile(
    r"""(?P<comment>//[^\n]*|/\*(?:[^*]|\*(?!/))*\*/)
      | (?P<string>b?"(?:[^"\\]|\\(?:.|\n))*"|b?r(?P<hashes>\#*)"(?:.|\n)*?"(?P=hashes))
      | (?P<char>b?'(?:[^'\\]|\\(?:u\{[^}]*\}|.)[^']*)')
      | (?P<word>'?[A-Za-z_][A-Za-z_0-9]*)
      | (?P<colons>::)
      | (?P<other>\S)""",
    re.VERBOSE,
)
OPEN, CLOSE = {"{": "}", "(": ")", "[": "]"}, {"}", ")", "]"}
ITEMS = {"struct", "enum", "union", "trait", "fn", "const", "static", "type", "mod"}
QUALIFIERS = {"unsafe", "async", "extern", "mut", "auto"}

Token = collections.namedtuple("Token", "text line")


def tokens_of(text):
    line, at, found = 1, 0, []
    for match in TOKEN.finditer(text):
        line += text.count("\n", at, match.start())
        at = match.start()
        if match.lastgroup == "comment":
            continue
        found.append(Token(match.group(), line))
    return found


class Module:
    """One module: what it defines, imports, and names in its code."""

    def __init__(self, path, file, parent):
        self.path, self.file, self.parent = path, file, parent
        self.children, self.defined = {}, set()
        self.imports, self.globs = {}, []  # name -> Path, and Paths of `*`
        self.uses, self.reexports, self.paths = [], [], []
        self.words = collections.Counter()

    def below(self):
        """This module and all below it."""
        yield self
        for child in self.children.values():
            yield from child.below()


Path = collections.namedtuple("Path", "segments line")


def skip_group(tokens, at):
    """The place behind the bracket that closes the one at `at`."""
    depth = 0
    for index in range(at, len(tokens)):
        if tokens[index].text in OPEN:
            depth += 1
        elif tokens[index].text in CLOSE:
            depth -= 1
            if depth == 0:
                return index + 1
    return len(tokens)


def read_use(tokens, at, prefix=()):
    """The leaves of a use tree from `at`, as (path, name or `*`), and the place behind it."""
    segments, leaves = list(prefix), []
    line = tokens[at].line
    while at < len(tokens):
        text = tokens[at].text
        if text == "{":
            end = skip_group(tokens, at)
            at += 1
            while at < end - 1:
                if tokens[at].text == ",":
                    at += 1
                    continue
                inner, at = read_use(tokens, at, segments)
                leaves += inner
            return leaves, end
        if text == "*":
            return leaves + [(Path(tuple(segments), line), "*")], at + 1
        if text in {",", ";", "}"}:
            break
        if text == "as":
            return leaves + [(Path(tuple(segments), line), tokens[at + 1].text)], at + 2
        if text != "::" and not (text == "self" and segments):
            segments.append(text)
        at += 1
    return leaves + [(Path(tuple(segments), line), segments[-1])], at


def read_paths(module, tokens):
    """Notes the paths `a::b::c` and all words of a stretch of code."""
    at = 0
    while at < len(tokens):
        text = tokens[at].text
        if not re.match(r"[A-Za-z_]", text):
            at += 1
            continue
        segments, line = [text], tokens[at].line
        module.words[text] += 1
        starts = at == 0 or tokens[at - 1].text != "::"
        while at + 2 < len(tokens) and tokens[at + 1].text == "::" and re.match(r"[A-Za-z_]", tokens[at + 2].text):
            at += 2
            segments.append(tokens[at].text)
        if starts and len(segments) > 1:
            module.paths.append(Path(tuple(segments), line))
        at += 1


def files_of_child(module, name, attributes):
    """The files that a `mod name;` may mean: more than one where an attribute names another for some targets."""
    named = re.findall(r'path = "([^"]+)"', attributes)
    folder = module.file.parent
    if module.file.name not in {"mod.rs", "lib.rs", "main.rs"}:
        folder = folder / module.file.stem
    candidates = [module.file.parent / path for path in named] or [folder / f"{name}.rs", folder / name / "mod.rs"]
    return [file for file in candidates if file.is_file()]


def read_items(module, tokens):
    at = 0
    while at < len(tokens):
        attributes, start = "", at
        while at < len(tokens) and tokens[at].text == "#":
            bracket = at + 1 + (tokens[at + 1].text == "!")
            end = skip_group(tokens, bracket)
            attributes += " ".join(token.text for token in tokens[at:end])
            read_paths(module, tokens[bracket:end])
            at = end
        if at >= len(tokens):
            break
        public = tokens[at].text == "pub"
        if public:
            at += 1
            if tokens[at].text == "(":
                at = skip_group(tokens, at)
        while tokens[at].text in QUALIFIERS or tokens[at].text.startswith('"'):
            at += 1
        if tokens[at].text == "const" and tokens[at + 1].text in {"fn", "unsafe"}:
            at += 1
        test = re.search(r"cfg \( (?:all \( )?test\b", attributes)
        word = tokens[at].text
        if word == "use":
            leaves, at = read_use(tokens, at + 1)
            at += 1
            for path, name in [] if test else leaves:
                if name == "*":
                    module.globs.append(path)
                else:
                    module.imports[name] = path
                (module.reexports if public else module.uses).append((path, name))
            continue
        if word == "mod" and tokens[at + 2].text in {";", "{"}:
            name, inline = tokens[at + 1].text, tokens[at + 2].text == "{"
            end = skip_group(tokens, at + 2) if inline else at + 3
            if not test:
                child = Module(f"{module.path}::{name}", module.file, module)
                module.children[name] = child
                if inline:
                    read_items(child, tokens[at + 3 : end - 1])
                for file in [] if inline else files_of_child(module, name, attributes):
                    child.file = file
                    read_items(child, tokens_of(file.read_text(encoding="utf-8")))
            at = end
            continue
        if word in ITEMS:
            module.defined.add(tokens[at + 1].text)
        # To the end of the item: a semicolon, or the block that is its body.
        begin = at
        while at < len(tokens) and tokens[at].text != ";":
            if tokens[at].text in OPEN:
                block = tokens[at].text == "{"
                at = skip_group(tokens, at)
                if block and not (at < len(tokens) and tokens[at].text in {";", ".", "?"}):
                    break
            else:
                at += 1
        if at < len(tokens) and tokens[at].text == ";":
            at += 1
        if not test:
            read_paths(module, tokens[begin:at])
        at = max(at, start + 1)


def resolve(path, module, root, seen=()):
    """(the module that a path leads to, whether the path is that module itself); None for another crate's."""
    first, *rest = path.segments
    if first == "crate":
        here = root
    elif first == "self":
        here = module
    elif first == "super":
        here = module.parent
    elif first in module.children:
        here = module.children[first]
    elif first in module.imports and (module, first) not in seen:
        found = resolve(module.imports[first], module, root, (*seen, (module, first)))
        if found is None or not found[1]:
            return found
        here = found[0]
    else:
        return None
    for place, segment in enumerate(rest):
        if here is None:
            return None
        if segment == "super":
            here = here.parent
        elif segment in here.children:
            here = here.children[segment]
        elif segment in here.defined:
            return here, False
        elif segment in here.imports and (here, segment) not in seen:
            found = resolve(here.imports[segment], here, root, (*seen, (here, segment)))
            if found is None or not found[1]:
                return found
            here = found[0]
        else:
            for glob in here.globs:
                found = resolve(glob, here, root, (*seen, (here, "*")))
                if found and found[1] and segment in found[0].defined:
                    return found[0], False
            return here, False
    return None if here is None else (here, True)


def dependencies(root):
    """{(module, module it depends on): the place that shows it}."""
    edges = {}
    for module in root.below():
        named = module.uses + [(path, name) for path, name in module.reexports if module.words[name] > 0]
        for path in [path for path, _ in named] + module.paths:
            found = resolve(path, module, root)
            # Importing a module brings a name; what is then reached through it counts.
            if found and not found[1] and found[0] is not module:
                edges.setdefault((module, found[0]), f"{module.file}:{path.line}")
        for path, name in module.uses:
            if name == "*" and (found := resolve(path, module, root)) and found[0] is not module:
                edges.setdefault((module, found[0]), f"{module.file}:{path.line}")
    return edges


def circles(graph):
    """Strongly connected sets of more than one node (Tarjan)."""
    index, low, stack, found = {}, {}, [], []

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in graph.get(node, ()):
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            members = []
            while not members or members[-1] != node:
                members.append(stack.pop())
            if len(members) > 1:
                found.append(members)

    for node in list(graph):
        if node not in index:
            visit(node)
    return found


def line_up(module):
    """The module and its ancestors, the crate's root first."""
    line = []
    while module:
        line.insert(0, module)
        module = module.parent
    return line


def check_crate(file, name):
    """Complaints about one crate root, and how much was looked at."""
    root = Module(name, file, None)
    read_items(root, tokens_of(file.read_text(encoding="utf-8")))
    edges = dependencies(root)
    # For each module the graph of what is directly below it; its own code is a node of its own.
    levels = collections.defaultdict(lambda: collections.defaultdict(dict))
    for (user, used), place in edges.items():
        ours, theirs = line_up(user), line_up(used)
        common = next((i for i, pair in enumerate(zip(ours, theirs)) if pair[0] is not pair[1]), min(len(ours), len(theirs)))
        parent = ours[common - 1]
        a = ours[common].path if common < len(ours) else f"{parent.path} (own code)"
        b = theirs[common].path if common < len(theirs) else f"{parent.path} (own code)"
        levels[parent.path][a].setdefault(b, f"{place}: {user.path} uses {used.path}")
    complaints = []
    for graph in levels.values():
        for members in circles(graph):
            complaints.append("circle of " + ", ".join(sorted(members)) + ":")
            for a in sorted(members):
                complaints += [f"    {place}" for b, place in sorted(graph[a].items()) if b in members]
    modules = sum(1 for _ in root.below())
    return complaints, f"{name}: {modules} modules, {len(edges)} dependencies"


def check_order(manifests):
    """Complaints about crates that depend on one of a later line."""
    level = {name: number for number, names in enumerate(ORDER) for name in names}
    for file, manifest in manifests:
        name = manifest["package"]["name"]
        if name not in level:
            yield f"{file}: {name} has no place in the order of crates: give it one in tests/harness/modules.py"
            continue
        sections = [manifest, *manifest.get("target", {}).values()]
        for section in sections:
            for kind in ("dependencies", "dev-dependencies", "build-dependencies"):
                for used in section.get(kind, {}):
                    if used in level and level[used] >= level[name]:
                        yield f"{file}: {name} depends on {used}, which is not below it"


def main():
    top = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    found = [file for file in sorted(top.rglob("Cargo.toml")) if not {"target", ".git"} & set(file.relative_to(top).parts)]
    manifests = [(file, tomllib.loads(file.read_text(encoding="utf-8"))) for file in found]
    manifests = [(file, manifest) for file, manifest in manifests if "package" in manifest]
    complaints = list(check_order(manifests))
    for file, manifest in manifests:
        for root in ("lib.rs", "main.rs"):
            source = file.parent / "src" / root
            if source.is_file():
                circles_found, summary = check_crate(source, manifest["package"]["name"])
                complaints += circles_found
                print(summary)
    print("\n".join(complaints) or "no circle, no dependency that points up")
    sys.exit(1 if complaints else 0)


if __name__ == "__main__":
    main()
