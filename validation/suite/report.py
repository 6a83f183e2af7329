"""The table of a run of the suite: as text, as Markdown and as HTML, with the figures; and the results in the READMEs."""

import base64
import html
import re
from pathlib import Path

HEAD = ("case", "quantity", "expected", "found", "error", "tolerance", "seconds")
RESULT = re.compile(r"(<!-- result -->\n).*?(<!-- end of result -->)", re.DOTALL)
PAGE = Path(__file__).resolve().parents[2] / "src/report/page"  # the frame of the program's own reports


def number_text(number, row, percent):
    return f"{100 * number:.2g} %" if percent and row["kind"] == "relative" else f"{number:.2g}"


def error_text(row, percent=False):
    if row["error"] is None:
        return "none" if row["met"] else "differs"
    return number_text(row["error"], row, percent) + ("" if row["kind"] == "relative" else " (absolute)")


def tolerance_text(row, percent=False):
    return "same" if row["tolerance"] is None else number_text(row["tolerance"], row, percent)


def cells_of(row, percent=False):
    verdict = error_text(row, percent) + ("" if row["met"] else ", MISS")
    return [row["case"], row["quantity"], row["expected"], row["found"], verdict, tolerance_text(row, percent),
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


def framed(title, body):
    """The whole page: one file that needs no other."""
    texts = {"title": html.escape(title), "style": (PAGE / "frame.css").read_text(encoding="utf-8"), "body": body,
             "programs": '<script>\n(() => {\n"use strict";\n' + (PAGE / "frame.js").read_text(encoding="utf-8") + "})();\n</script>\n"}
    return re.sub(r"\{\{(\w+)\}\}", lambda match: texts[match[1]], (PAGE / "frame.html").read_text(encoding="utf-8"))


def html_table(rows):
    head = "".join(f"<th{' class=number' if i >= 2 else ''}>{name}</th>" for i, name in enumerate(HEAD))
    parts = [f'<div class="scroll" tabindex="0"><table class="sortable"><thead><tr>{head}</tr></thead>\n<tbody>']
    for row in rows:
        cells = [html.escape(cell) for cell in cells_of(row, percent=True)]
        cells[0] = f"<a href=\"#{row['case']}\">{cells[0]}</a>"
        numbers = "".join(f"<td{' class=number' if i >= 2 else ''}>{cell}</td>" for i, cell in enumerate(cells))
        parts.append(f"<tr{'' if row['met'] else ' class=marked'}>{numbers}</tr>")
    return "\n".join([*parts, "</tbody></table></div>"])


def answer_of(outcomes):
    rows = [row for outcome in outcomes for row in outcome["rows"]]
    misses = sum(not row["met"] for row in rows)
    words = (f"all of {len(rows)} quantities within tolerance" if not misses
             else f"{misses} of {len(rows)} quantities missed")
    return (f'<div class="answer{" open" if misses else ""}" role="region" aria-label="Answer"><p class="name">Validation</p>'
            f'<p class="value">{words}</p><p>{html.escape(introduction(outcomes))}</p></div>')


def write_html(path, outcomes):
    parts = ["<h1>Validation report</h1>", answer_of(outcomes), '<section class="long"><h2>All quantities</h2>',
             html_table([row for outcome in outcomes for row in outcome["rows"]]), "</section>"]
    for outcome in outcomes:
        title = html.escape(outcome["title"])
        parts.append(f"<section id=\"{outcome['case']}\"><h2>{title}</h2>")
        figure = path.parent / outcome["case"] / "figure.png"
        if outcome["figure"] and figure.exists():
            picture = base64.b64encode(figure.read_bytes()).decode("ascii")
            parts.append(f'<figure><img src="data:image/png;base64,{picture}" alt="{title}" loading="lazy"></figure>')
        if outcome["failure"]:
            parts.append(f"<p>The check ended early: <code>{html.escape(outcome['failure'].splitlines()[0])}</code></p>")
        parts.append(html_table(outcome["rows"]) + "</section>")
    path.write_text(framed("Validation report", "\n".join(parts) + "\n"), encoding="utf-8")


def update_readme(path, rows):
    """Puts the table of the case between the marks of its README; without seconds, which differ from run to run."""
    text = path.read_text(encoding="utf-8")
    new = RESULT.sub(lambda match: match[1] + markdown_table(rows, range(1, 6)) + match[2], text)
    if new != text:
        path.write_text(new, encoding="utf-8")
