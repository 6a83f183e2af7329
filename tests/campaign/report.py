"""The table of a campaign, as docs/reliability.md has it."""

import json

HEAD = """# Reliability

What Kluft does where something goes wrong around it. `scripts/campaign` disturbs the built programs in every way that its table
names and looks at what they leave. A failure is a crash, a hang, a file without its end, tables of two runs in one, a result
lost or changed without a word, a number that is none, or an exit code other than the promised one. `scripts/fuzz` gives the
readers of files mutants of files that reach new code, with the address and undefined behaviour sanitizers. This page is written by
`scripts/campaign --docs`.

"""
KINDS = """
What was done:

- *kills*: SIGKILL at a random call on a file or at a random moment, of runs (also resumed ones, with the explicit integrator and
  in the search for a factor of safety), studies and calibrations. The same command again, with `--resume` where there is a state, must
  end with the tables of an undisturbed run, to the last digit (with `solver.repeatable`; a factor of safety within 1 %).
- *calls on files that fail*: the n-th write (also half of it), fsync, rename, open, close or truncation, once, twice or from then
  on. *Allocations that fail*: the n-th one, or all from it on, in every command.
- *limits*: `ulimit -v`, `-f`, `-t`; *full disks*: a small tmpfs (without root: writes that fail from the n-th on); *output without
  room*: standard output on `/dev/full`, closed, or with nobody who reads.
- *signals*: HUP, INT, TERM, PIPE, QUIT, XCPU, XFSZ, USR1 in the midst of a run, study or calibration; *several processes*: a run, study,
  calibration or resumption beside another one in its directory; a run of another scene is refused there.
- *damaged states* and *tables*: bits that flip, bytes that change, ends, rows or whole files that are missing, before `--resume`.
- *mistakes*: random changes of scenes, studies and maps for `kluft check` and `kluft study --emit`.
- *hard scenes*: joints from k_n d/E 1e-3 to 1e6, needles, snap-backs, mechanisms, maps with nets, tiny and huge units.
- *resumed after each step* of five scenes, *repeated* with one and two threads: identical tables. *Ten thousand steps*: memory and
  time per step do not grow (resident memory by less than 2 MB, CPU time per step by less than a half between the first and
  the last third of the run, before its summary, for which the tables are read).
"""
NOT_COVERED = """
## What is not covered

- Power that fails: that what fsync has promised is on the disk is taken from the system. Network file systems, other systems than Linux,
  other file systems than the one of the trials and tmpfs.
- Memory or disks that change data by themselves while a run goes on. A scene or a table that somebody edits meanwhile.
- Faults inside HDF5, OpenBLAS, SuiteSparse, Cairo and the C library other than lack of memory and calls on files that fail; threads that
  cannot be started. Calls that the C library makes without its own public names are not made to fail.
- Bodies of more than some hundred blocks: faults, kills and repeats are tried on small ones, where every kind of file is written as well.
- Time: nothing is said of how fast a run ends after a signal beyond the bound for hangs ({limit:.0f} s a process, 300 s of a hard scene).
- Pictures and reports are looked at for their ends and for numbers that are none, not for what they show.
- Libraries are not instrumented in fuzzing; what the readers hand on (a body being cut, a run) is not fuzzed. Saved states are read, not
  resumed, by the fuzz target; the campaign resumes damaged ones. A state file is refused by its digest before HDF5 reads it, since HDF5
  1.10 itself crashes on some damaged headers; so half of the mutants are whole files, with a right digest, in which arrays have other
  numbers, lengths or types. A file that somebody damages on purpose and gives a right digest is not covered.
- Right numbers are the matter of `validation/`.
"""

UNREACHED = """
Branches that only an exception takes do not count. What is not reached: in apps, what runs only in a process that is killed or leaves
at once (handlers of signals, lack of memory), which leaves no counters, and what the slow tests and those of calibration reach, which
are not in that build; in kinematics and core, templates and inline functions, whose branches count once for each source that they are
compiled into; elsewhere mostly messages for files and systems that fail in ways that the campaign tries and the tests do not.
"""


def table(rows):
    lines = ["| " + " | ".join(str(cell).replace("|", "/") for cell in row) + " |" for row in rows]
    lines.insert(1, "|---|" + "---:|" * (len(rows[0]) - 1))
    return "\n".join(lines) + "\n"


def fuzz_rows(directory):
    """What scripts/fuzz left of its readers."""
    results = [json.loads(path.read_text()) for path in sorted(directory.glob("*.json"))]
    return [[each["reader"], f"{each['executions']:,}".replace(",", " "), each["failures"], f"{each['seconds'] / 60:.1f}"] for each in results]


def coverage_rows(file):
    """What scripts/coverage left of each folder."""
    folders = json.loads(file.read_text()) if file.is_file() else {}
    return [[folder, lines_in_all, f"{100 * lines / lines_in_all:.1f}", f"{100 * branches / max(1, branches_in_all):.1f}"]
            for folder, (lines, lines_in_all, branches, branches_in_all) in folders.items()]


def text_of(results, about, measured, limit):
    """`results`: kind -> (trials by number, seconds). `about`: what was tested where. `measured`: the directory in which
    scripts/fuzz and scripts/coverage have left their numbers."""
    text = HEAD + about + "\n\n"
    text += table([["kind", "trials", "failures", "minutes"]] + [
        [kind, len(trials), sum(bool(t.problems) for t in trials.values()), f"{seconds / 60:.1f}"] for kind, (trials, seconds) in results.items()])
    readers = fuzz_rows(measured / "fuzz")
    if readers:
        text += "\n" + table([["reader that is fuzzed", "executions", "failures", "minutes"], *readers])
    folders = coverage_rows(measured / "coverage/folders.json")
    if folders:
        text += "\n" + table([["folder, as the tests reach it", "lines", "% of lines", "% of branches"], *folders]) + UNREACHED
    failures = [(kind, i, trial) for kind, (trials, _) in results.items() for i, trial in sorted(trials.items()) if trial.problems]
    text += "\n## Failures\n\n" + ("" if failures else "None.\n")
    for kind, i, trial in failures:
        text += f"- {trial.outcome}: {'; '.join(trial.problems)}  \n  `scripts/campaign --kind '{kind}' --trial {i}`  \n  `{trial.command}`\n"
    return text + KINDS + NOT_COVERED.format(limit=limit)
