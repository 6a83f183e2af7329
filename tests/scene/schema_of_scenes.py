"""The JSON Schema that `kluft schema` says takes every scene of the project and refuses mistakes, by an independent validator.

usage: schema_of_scenes.py KLUFT
"""

import copy
import json
import subprocess
import sys
from pathlib import Path

import jsonschema
import yaml

ROOT = Path(__file__).resolve().parents[2]
LEAST_SCENES = 50  # of the repository: fewer means that they were looked for in the wrong place
MISTAKES = [("materials", "rock", "youngs_modulus", "-1"), ("materials", "rock", "densty", 2300), ("analysis", "plane", "strian"),
            ("stages", 0, "steps", 0), ("stages", 0, "steps", 1.5), ("geometry", "domain", 3), ("solvr", {}), ("kluft", None)]


def scenes():
    for path in sorted([*ROOT.glob("models/**/*.yaml"), *ROOT.glob("validation/**/*.yaml"), *ROOT.glob("bench/**/*.yaml")]):
        content = yaml.safe_load(path.read_text())
        if isinstance(content, dict) and ("kluft" in content or "extends" in content):
            yield path.relative_to(ROOT), content


def with_mistake(scene, path, value):
    changed = copy.deepcopy(scene)
    place = changed
    for key in path[:-1]:
        place = place[key] if isinstance(place, list) else place.setdefault(key, {})
    if value is None:
        del place[path[-1]]
    else:
        place[path[-1]] = value
    return changed


def main(kluft):
    schema = json.loads(subprocess.run([kluft, "schema"], capture_output=True, check=True, text=True).stdout)
    jsonschema.Draft202012Validator.check_schema(schema)
    validator = jsonschema.Draft202012Validator(schema)
    found = list(scenes())
    failures = [f"{path}: {list(error.path)}: {error.message}" for path, scene in found for error in validator.iter_errors(scene)]
    quickstart = dict((str(path), scene) for path, scene in found)["models/quickstart.yaml"]
    failures += [f"quickstart with {mistake} is taken" for mistake in MISTAKES
                 if validator.is_valid(with_mistake(quickstart, mistake[:-1], mistake[-1]))]
    if len(found) < LEAST_SCENES:
        failures.append(f"only {len(found)} scenes found")
    print("\n".join(failures) or f"{len(found)} scenes are taken, {len(MISTAKES)} mistakes are refused")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
