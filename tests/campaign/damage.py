"""Saved states and tables of a run that are cut, changed or lost, before --resume."""

import shutil

from bench import BAD_INPUT, DONE, TABLES, Trial, differences, numbers_that_are_none
from kills import SHIM


def halfway(bench):
    """The results of a run that was killed at its third state."""
    with bench.lock:
        cwd = bench.work / "halfway"
        if not cwd.exists():
            cwd.mkdir()
            bench.call(bench.run(), cwd, env={"LD_PRELOAD": bench.library(SHIM), "KLUFT_CALL": "rename", "KLUFT_CALL_AT": 4, "KLUFT_CALL_ERRNO": 0,
                                              "KLUFT_CALL_BELOW": cwd / "out/state.h5"})
        return cwd / "out"


def resumed(bench, kind, i, which, damage):
    """A damaged file is refused with its name, or the run ends as if nothing had happened."""
    cwd, words = bench.place(kind, i), bench.run("quick.yaml", "--resume")
    out, reference = cwd / "out", bench.reference(bench.run())
    shutil.copytree(halfway(bench) if i % 2 else reference, out)
    before = (out / which).read_bytes()
    after = damage(before)
    (out / which).write_bytes(after) if after is not None else (out / which).unlink()
    end = bench.call(words, cwd)
    problems = end.crash()
    if end.code == DONE:
        problems += differences(out, reference, words)
    elif not problems and (end.code != BAD_INPUT or which not in end.err):
        problems.append(f"exit {end.code}: {end.said()}")
    return Trial(f"{which}, exit {end.code}", problems + numbers_that_are_none(cwd), bench.shell(words))


def states(bench, i):
    rng = bench.rng("damaged states", i)

    def damage(data):
        if i % 4 == 0:
            return data[:rng.randrange(len(data))]
        data = bytearray(data)
        for _ in range(rng.choice([1, 1, 3, 30])):
            # where HDF5 keeps its own numbers is the more dangerous
            at = rng.randrange(len(data) if i % 4 == 1 else min(len(data), 4096))
            data[at] ^= 1 << rng.randrange(8) if i % 4 < 3 else rng.randrange(1, 256)
        return bytes(data)

    return resumed(bench, "states", i, "state.h5", damage)


def tables(bench, i):
    rng = bench.rng("damaged tables", i)
    way = i // len(TABLES) % 7

    def damage(data):
        at, lines = rng.randrange(1, len(data)), data.splitlines(keepends=True)
        line = rng.randrange(len(lines))
        return [data[:at], data[:at] + bytes([data[at] ^ 1]) + data[at + 1:], data[:at] + bytes(min(100, len(data) - at)) + data[at + 100:],
                b"".join(lines[:-1]), b"".join(lines[:line] + lines[line + 1:]), b"".join(lines[:line] + lines[line:line + 1] + lines[line:]),
                None][way]

    return resumed(bench, "tables", i, TABLES[i % len(TABLES)], damage)


KINDS = {"damaged states": (states, 3, None), "damaged tables": (tables, 1, None)}
