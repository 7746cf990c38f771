#!/usr/bin/env python3
"""Which changes of the protection does the suite on the bench not notice?

Each change that cargo-mutants proposes (a condition turned round, a branch removed, a result replaced) is built into the
served unit, in a work tree of its own, and the default suite is run against it in lock step. The unit's own tests are
not run: what is asked is whether a bench would find the change.

    cargo install cargo-mutants
    cargo build --release -p ptu-app
    ato-under-test/mutants.py                                   # all of src/atp, about an hour
    ato-under-test/mutants.py --files 'ato-under-test/src/atp/doors.rs'
    ato-under-test/mutants.py --again mutants.jsonl             # those of a list that were missed

Changes of `mutants_equivalent.toml` are not made: no bench can see them, and each has its reason there.

Prints one JSON line for each change, and at the end the shares, of each file and of all.
"""

import argparse
import collections
import json
import pathlib
import re
import subprocess
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent
TREE = ROOT / "target/mutants/tree"
PTU = ROOT / "target/release/ptu"
EQUIVALENT = ROOT / "ato-under-test/mutants_equivalent.toml"
# A unit that loses its time never ends a suite; a sound one takes about six seconds.
LONGEST_S = 300
# How `ptu run` ends.
VERDICTS = {0: "missed", 1: "failed", 3: "error"}


def proposed(files):
    listed = subprocess.run(
        ["cargo", "mutants", "--list", "--json", "--diff", "-f", files],
        cwd=ROOT, check=True, capture_output=True, text=True,
    )
    return json.loads(listed.stdout)


def identity(name):
    """The change without its line and column, which move with the text around it."""
    return re.sub(r":\d+:\d+:", ":", name)


def in_words(change):
    """The change, and the line that it is made in: neither moves with the text around them."""
    what = change["name"].split(": ", 1)[1]
    line = (ROOT / change["file"]).read_text().splitlines()[change["span"]["start"]["line"] - 1]
    return what, line.strip()


def equivalent(changes):
    """Which of the changes no bench can see. Every entry of the list must be one that is proposed."""
    listed = {(entry["change"], entry["line"]) for entry in tomllib.loads(EQUIVALENT.read_text())["equivalent"]}
    functions = {change["function"]["function_name"] for change in changes}
    stale = [what for what in listed - set(map(in_words, changes)) if what[0].rsplit(" in ", 1)[-1] in functions]
    if stale:
        sys.exit(f"{EQUIVALENT.name} lists what is not proposed: {stale}")
    return [change for change in changes if in_words(change) in listed]


def unit_fails(change):
    """How the suite ends on a unit with this change."""
    file = TREE / change["file"]
    sound = file.read_text()
    diff = change["diff"].replace("+++ ", f"+++ {change['file']}\t", 1)
    try:
        subprocess.run(["patch", "-p0", "-s"], input=diff, cwd=TREE, check=True, text=True)
        built = subprocess.run(["cargo", "build", "-q", "-p", "ato-under-test"], cwd=TREE, capture_output=True)
        return "unviable" if built.returncode else suite()
    finally:
        file.write_text(sound)


def suite():
    unit = subprocess.Popen(
        [TREE / "target/debug/ato-under-test", "--pty", "--lock-step"], stdout=subprocess.PIPE, text=True,
    )
    try:
        port = unit.stdout.readline().strip()
        database = TREE.parent / "runs.db"
        database.unlink(missing_ok=True)
        run = subprocess.run(
            [PTU, "run", "--stop-on-fail", "--unit", f"lockstep:{port}", "--db", database],
            cwd=ROOT, capture_output=True, timeout=LONGEST_S,
        )
        return VERDICTS.get(run.returncode, f"exit {run.returncode}")
    except subprocess.TimeoutExpired:
        return "endless"
    finally:
        unit.kill()
        unit.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--files", default="ato-under-test/src/atp/**", help="glob of files to change")
    parser.add_argument("--again", help="list of an earlier run: only what it missed")
    asked = parser.parse_args()
    changes = proposed(asked.files)
    unseen = equivalent(changes)
    changes = [change for change in changes if change not in unseen]
    if asked.again:
        before = [json.loads(line) for line in open(asked.again) if line.startswith("{")]
        missed = {identity(change["name"]) for change in before if change["ends"] == "missed"}
        changes = [change for change in changes if identity(change["name"]) in missed]
    head = subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, check=True, capture_output=True, text=True).stdout.strip()
    if TREE.exists():
        subprocess.run(["git", "checkout", "-q", "--force", "--detach", head], cwd=TREE, check=True)
    else:
        subprocess.run(["git", "worktree", "add", "-q", "--detach", TREE], cwd=ROOT, check=True)
    ends = {}
    for change in changes:
        ends[change["name"]] = unit_fails(change)
        print(json.dumps({"name": change["name"], "ends": ends[change["name"]]}), flush=True)
    for file in sorted({name.split(":")[0] for name in ends}):
        tell(file, ends, unseen)
    tell("", ends, unseen)


def tell(file, ends, unseen):
    """How many changes of a file, or of all, were noticed."""
    counts = collections.Counter(end for name, end in ends.items() if name.startswith(file))
    made = sum(counts.values()) - counts["unviable"]
    found = made - counts["missed"]
    beside = sum(change["file"].startswith(file) for change in unseen)
    print(f"{file or 'all'}: {found} of {made} changes noticed, {beside} equivalent; {dict(counts)}", file=sys.stderr)


if __name__ == "__main__":
    main()
