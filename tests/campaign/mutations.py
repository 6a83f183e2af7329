"""Scenes, studies and maps with random mistakes: each is checked, or refused with its file's name. Never a crash or a hang."""

import re
import resource
import shutil

from bench import DONE, BAD_INPUT, NO_RESOURCES, ROOT, Trial

SCENES = ["quickstart.yaml", "triaxial/model-c.yaml", "triaxial/case-1.yaml", "calibration/intact.yaml"]
VALUES = ["0", "-1", "1e-300", "1e30", "nan", ".inf", "-.inf", "null", "''", "[]", "{}", "[[0, 0], [0, 0], [1, 1]]", "true", "3 parsec",
          "25 MPa", "100000000000000000000", "top", "{a: 1}", "[1, 2, 3]", "\"\\u0000\"", "0x10", "-0.0", "1e-12 m", "&a [*a]"]
NUMBER = re.compile(r"-?\d+(\.\d+)?([eE][-+]?\d+)?")
GIGABYTE = 1 << 30


def mutated(text, rng):
    """The text with one to four mistakes, as of somebody who types or a file that got hurt."""
    for _ in range(rng.choice([1, 1, 2, 4])):
        lines, way = text.splitlines(keepends=True), rng.randrange(9)
        at, place = rng.randrange(max(1, len(text))), rng.randrange(max(1, len(lines)))
        numbers = list(NUMBER.finditer(text))
        if way <= 2 and numbers:
            which = rng.choice(numbers)
            text = text[:which.start()] + rng.choice(VALUES) + text[which.end():]
        elif way == 3 and ":" in text:
            which = rng.choice(list(re.finditer(r": *[^\n,{}\]]+", text)) or [re.search(":", text)])
            text = text[:which.start()] + ": " + rng.choice(VALUES) + text[which.end():]
        elif way == 4:
            text = text[:at] + rng.choice(["\t", "\n", " ", ":", "-", "[", "}", "\0", "é", "#", "&", "*", "!", "|"]) + text[at:]
        elif way == 5:
            text = text[:at] + text[at + rng.randint(1, 12):]
        elif way == 6 and lines:
            text = "".join(lines[:place] + lines[place + 1:])
        elif way == 7 and lines:
            other = rng.randrange(len(lines))
            lines[place], lines[other] = lines[other], lines[place]
            text = "".join(lines)
        elif way == 8 and lines:
            text = "".join(lines[:place] + lines[place:place + 1] + lines[place:])
    return text


def mutations(bench, i):
    rng, cwd = bench.rng("mutations", i), bench.place("mutations", i)
    name = rng.choice(SCENES + ["studies/steps.yaml", "data/outcrop-kb7/area.geojson", "data/outcrop-kb7/traces.geojson"])
    shutil.copytree(ROOT / "models", cwd, dirs_exist_ok=True)
    (cwd / name).write_text(mutated((cwd / name).read_text(), rng))
    words = ["check", "outcrop-kb7.yaml" if name.endswith("geojson") else name]
    if name.startswith("studies"):
        words = ["study", name, "-o", "out", "--emit", "make"]
    end = bench.call(words, cwd, limits=[(resource.RLIMIT_AS, 4 * GIGABYTE)])
    problems = end.crash()
    if not problems and end.code not in (DONE, BAD_INPUT, NO_RESOURCES):
        problems.append(f"exit {end.code}: {end.said()}")
    if end.code in (BAD_INPUT, NO_RESOURCES) and not end.err.strip():
        problems.append("no message")
    return Trial(f"{name.rsplit('/', 1)[-1]}, exit {end.code}", problems, f"(ulimit -v {4 << 20}; {bench.shell(words)})")


KINDS = {"scenes, studies and maps with mistakes": (mutations, 2, None)}
