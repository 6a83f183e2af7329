"""The JSON Schemas that `kluft schema` says take every scene, study and calibration of the project and refuse mistakes, by an
independent validator, and are those of docs/schema, which the models name for editors.

usage: schemas_of_files.py KLUFT [--without-calibration]

With KLUFT_WRITE_DOCS in the environment it writes docs/schema anew.
"""

import copy
import json
import os
import subprocess
import sys
from pathlib import Path

import jsonschema
import yaml

ROOT = Path(__file__).resolve().parents[2]
# Of each kind: a file of the project, what is wrong in it as a path and a value (None: the key is missing), and how many files the
# project has at least: fewer means that they were looked for in the wrong place.
KINDS = {
    "scene": ("models/quickstart.yaml", 50,
              [("materials", "rock", "youngs_modulus", "-1"), ("materials", "rock", "densty", 2300), ("analysis", "plane", "strian"),
               ("stages", 0, "steps", 0), ("stages", 0, "steps", 1.5), ("geometry", "domain", 3), ("solvr", {}), ("kluft", None)]),
    "study": ("models/studies/steps.yaml", 1,
              [("scene", None), ("vry", {}), ("combine", "sum"), ("replicas", 0), ("replicas", {"seed": 1}), ("quantities", []),
               ("vary", "stages.1.steps", {"from": 1, "to": 2, "cont": 3}), ("vary", "stages.1.steps", []), ("time_limit", -1),
               ("variants", [{"set": {}}]), ("reference", "coarsest"), ("reference", {"values": {"peak_stress": [1]}})]),
    "calibration": ("models/calibration/intact-rock.yaml", 6,
                    [("scene", None), ("kluft_calibration", 2), ("parameters", {}), ("parameters", "kn", "start", None),
                     ("parameters", "kn", "keys", []), ("targets", "peak_stres", {}), ("replicas", 0),
                     ("targets", "youngs_modulus", {"value": "1 GPa"})]),
}


def kind_of(content):
    """The kind of a file with this content; None of one that is no file of the program."""
    if not isinstance(content, dict):
        return None
    if "kluft_calibration" in content:
        return "calibration"
    if "kluft" in content or "extends" in content:
        return "scene"
    return "study" if "scene" in content and {"vary", "variants", "replicas"} & set(content) else None


def files():
    """Path, text and content of each file of the project, by kind."""
    found = {kind: [] for kind in KINDS}
    for folder in ("models", "validation", "bench"):
        for path in sorted((ROOT / folder).glob("**/*.yaml")):
            text = path.read_text()
            content = yaml.safe_load(text)
            if (kind := kind_of(content)) is not None:
                found[kind].append((path, text, content))
    return found


def with_mistake(content, path, value):
    changed = copy.deepcopy(content)
    place = changed
    for key in path[:-1]:
        place = place[key] if isinstance(place, list) else place.setdefault(key, {})
    if value is None:
        del place[path[-1]]
    else:
        place[path[-1]] = value
    return changed


def failures_of(kluft, kind, found):
    text = subprocess.run([kluft, "schema", kind], capture_output=True, check=True, text=True).stdout
    stored = ROOT / "docs" / "schema" / f"{kind}.json"
    if "KLUFT_WRITE_DOCS" in os.environ:
        stored.write_text(text)
    if not stored.is_file() or stored.read_text() != text:
        yield f"{stored.relative_to(ROOT)} is not what kluft schema {kind} says; write it anew with KLUFT_WRITE_DOCS=1"
    schema = json.loads(text)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    for path, text, content in found:
        for error in validator.iter_errors(content):
            yield f"{path.relative_to(ROOT)}: {list(error.path)}: {error.message}"
        line = f"# yaml-language-server: $schema={os.path.relpath(stored, path.parent)}"
        if path.is_relative_to(ROOT / "models") and text.splitlines()[0] != line:
            yield f"{path.relative_to(ROOT)}: expected the first line {line}"
    name, least, mistakes = KINDS[kind]
    if len(found) < least:
        yield f"only {len(found)} files of the kind {kind} found"
    right = yaml.safe_load((ROOT / name).read_text())
    for mistake in mistakes:
        if validator.is_valid(with_mistake(right, mistake[:-1], mistake[-1])):
            yield f"{name} with {mistake} is taken"


def main(kluft, *options):
    found = files()
    kinds = [kind for kind in KINDS if kind != "calibration" or "--without-calibration" not in options]
    failures = [failure for kind in kinds for failure in failures_of(kluft, kind, found[kind])]
    print("\n".join(failures) or ", ".join(f"{len(found[kind])} of the kind {kind}" for kind in kinds) + ": taken; mistakes refused")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
