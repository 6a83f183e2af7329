"""The table of a run of the suite: as text, as Markdown and as HTML, with the figures; and the results in the READMEs."""

import html
import re

HEAD = ("case", "quantity", "expected", "found", "error", "tolerance", "seconds")
RESULT = re.compile(r"(<!-- result -->\n).*?(<!-- end of result -->)", re.DOTALL)
STYLE = """body { font: 15px/1.45 sans-serif; max-width: 62em; margin: 2em auto; padding: 0 1em; color: #1a1a1a }
table { border-collapse: collapse; font-size: 13px } td, th { padding: .2em .7em; border-bottom: 1px solid #ddd; text-align: left }
td.number { text-align: right; font-variant-numeric: tabular-nums } tr.miss td { background: #f8dedb } img { max-width: 100% }
h2 { margin-top: 2em }"""


def error_text(row):
    if row["error"] is None:
        return "none" if row["met"] else "differs"
    return f"{row['error']:.2g}" + ("" if row["kind"] == "relative" else " (absolute)")


def tolerance_text(row):
    return "same" if row["tolerance"] is None else f"{row['tolerance']:.2g}"


def cells_of(row):
    verdict = error_text(row) + ("" if row["met"] else ", MISS")
    return [row["case"], row["quantity"], row["expected"], row["found"], verdict, tolerance_text(row),
            f"{row['seconds']:.1f}"]


def text_table(rows):
    lines = [HEAD, *map(cells_of, rows)]
    widths = [max(len(line[i]) for line in lines) for i in range(len(HEAD))]
    return "\n".join("  ".join(cell.ljust(width) for cell, width in zip(line, widths)).rstrip() for line in lines)


def markdown_table(rows, columns):
    head = [HEAD[i] for i in columns]
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    for row in rows:
        cells = cells_of(row)
        lines.append("| " + " | ".join(cells[i].replace("|", "\\|") for i in columns) + " |")
    return "\n".join(lines) + "\n"


def closing_line(outcomes):
    rows = [row for outcome in outcomes for row in outcome["rows"]]
    misses = [row for row in rows if not row["met"]]
    cases = {row["case"] for row in misses}
    seconds = sum(outcome["seconds"] for outcome in outcomes)
    met = f"{len(outcomes)} cases, {len(rows)} quantities, {seconds:.0f} s in the program"
    return f"{met}: all within tolerance" if not misses else f"{met}: {len(misses)} missed in {', '.join(sorted(cases))}"


def title_of(readme):
    for line in readme.splitlines():
        if line.startswith("# "):
            return line[2:].strip()
    return ""


def introduction(outcomes):
    return ("Closed forms and published values against runs of the program. Errors are relative unless said; the seconds "
            f"of a case are those of all its runs. {closing_line(outcomes)}.")


def write_markdown(path, outcomes):
    rows = [row for outcome in outcomes for row in outcome["rows"]]
    text = f"# Validation report\n\n{introduction(outcomes)}\n\n{markdown_table(rows, range(len(HEAD)))}"
    for outcome in outcomes:
        text += f"\n## [{outcome['title']}]({outcome['case']}/README.md)\n"
        if outcome["figure"]:
            text += f"\n![{outcome['title']}]({outcome['case']}/figure.png)\n"
        if outcome["failure"]:
            text += f"\nThe check ended early: `{outcome['failure'].splitlines()[0]}`\n"
    path.write_text(text, encoding="utf-8")


def write_html(path, outcomes):
    parts = ["<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Validation report</title>"
             f"<style>{STYLE}</style></head><body>\n<h1>Validation report</h1>\n<p>{html.escape(introduction(outcomes))}</p>",
             "<table><tr>" + "".join(f"<th>{name}</th>" for name in HEAD) + "</tr>"]
    for outcome in outcomes:
        for row in outcome["rows"]:
            cells = [html.escape(cell) for cell in cells_of(row)]
            cells[0] = f"<a href=\"#{row['case']}\">{cells[0]}</a>"
            numbers = "".join(f"<td{' class=number' if i >= 2 else ''}>{cell}</td>" for i, cell in enumerate(cells))
            parts.append(f"<tr{'' if row['met'] else ' class=miss'}>{numbers}</tr>")
    parts.append("</table>")
    for outcome in outcomes:
        title = html.escape(outcome["title"])
        parts.append(f"<h2 id=\"{outcome['case']}\">{title}</h2>")
        if outcome["figure"]:
            parts.append(f"<p><img src=\"{outcome['case']}/figure.png\" alt=\"{title}\"></p>")
        if outcome["failure"]:
            parts.append(f"<p>The check ended early: <code>{html.escape(outcome['failure'].splitlines()[0])}</code></p>")
    path.write_text("\n".join(parts) + "\n</body></html>\n", encoding="utf-8")


def update_readme(path, rows):
    """Puts the table of the case between the marks of its README; without seconds, which differ from run to run."""
    text = path.read_text(encoding="utf-8")
    new = RESULT.sub(lambda match: match[1] + markdown_table(rows, range(1, 6)) + match[2], text)
    if new != text:
        path.write_text(new, encoding="utf-8")
