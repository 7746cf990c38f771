"""Holds every TOML file of a scripts directory to the schema that its .taplo.toml names.

check_schemas.py DIR
"""
import copy
import fnmatch
import json
import pathlib
import sys
import tomllib

import jsonschema

root = pathlib.Path(sys.argv[1])
rules = tomllib.loads((root / ".taplo.toml").read_text())["rule"]
# Texts of one language are a table of words, not of keys.
free = {"korean.toml"}
seen = set()
for file in sorted(root.rglob("*.toml")):
    name = file.relative_to(root).as_posix()
    if file.name.startswith(".") or name in free:
        continue
    fits = [
        rule for rule in rules
        if any(fnmatch.fnmatch(name, glob) for glob in rule["include"]) and name not in rule["exclude"]
    ]
    assert len(fits) == 1, f"{name}: {len(fits)} schemas"
    seen.add(fits[0]["schema"]["path"])
    schema = json.loads((root / fits[0]["schema"]["path"]).read_text())
    validator = jsonschema.Draft202012Validator(schema)
    validator.check_schema(schema)
    data = tomllib.loads(file.read_text())
    for error in validator.iter_errors(data):
        raise SystemExit(f"{name}: {error.message}")
    wrong = copy.deepcopy(data)
    wrong["no_such_key"] = 1
    assert not validator.is_valid(wrong), f"{name} may have any key"
unused = {rule["schema"]["path"] for rule in rules} - seen
assert not unused, f"no file has {unused}"
print(f"{len(seen)} schemas: each fits, and none with a wrong key")
