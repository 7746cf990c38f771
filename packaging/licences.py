#!/usr/bin/env python3
"""Collects the licence texts of all libraries that are linked into the programs.

licences.py TARGET DIR: one file for each different text, which names its libraries first.
"""
import collections
import json
import pathlib
import subprocess
import sys

target, folder = sys.argv[1], pathlib.Path(sys.argv[2])
metadata = json.loads(
    subprocess.run(
        ["cargo", "metadata", "--locked", "--format-version", "1", "--filter-platform", target],
        check=True, capture_output=True,
    ).stdout
)
packages = {package["id"]: package for package in metadata["packages"]}
nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
# What is linked: dependencies of the two programs, those for tests and builds alone left out.
linked, ahead = set(), [
    package["id"] for package in metadata["packages"] if package["name"] in ("ptu-app", "ptu-window", "ato-under-test")
]
while ahead:
    package = ahead.pop()
    if package in linked:
        continue
    linked.add(package)
    for dependency in nodes[package]["deps"]:
        if any(kind["kind"] is None for kind in dependency["dep_kinds"]):
            ahead.append(dependency["pkg"])
texts = collections.defaultdict(list)
without = []
for package in sorted((packages[one] for one in linked), key=lambda p: (p["name"], p["version"])):
    if package["source"] is None:
        continue
    name = f'{package["name"]} {package["version"]} ({package["license"]})'
    place = pathlib.Path(package["manifest_path"]).parent
    files = sorted(
        file for file in place.iterdir()
        if file.is_file() and file.name.upper().startswith(("LICENSE", "LICENCE", "COPYING", "UNLICENSE", "NOTICE"))
    )
    if not files:
        without.append(name)
    for file in files:
        texts[file.read_text(errors="replace").strip()].append(name)
folder.mkdir(parents=True, exist_ok=True)
for number, (text, names) in enumerate(sorted(texts.items(), key=lambda entry: entry[1][0]), 1):
    name = names[0].split()[0]
    listed = "\n".join(sorted(set(names)))
    (folder / f"{number:03}-{name}").write_text(f"{listed}\n\n{text}\n")
pretendard = pathlib.Path("ptu-app/report/fonts/Pretendard-LICENSE.txt")
(folder / "Pretendard").write_text(pretendard.read_text())
# A library that has no text of its own is under that of its declared licence, which others have.
(folder / "000-index").write_text(
    "Libraries without a text of their own; their licences are among the other files:\n" + "\n".join(without) + "\n"
)
