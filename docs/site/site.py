"""Makes the site of the documents in <build>/site: pages of docs/ and the READMEs beside the code, a gallery of models, validation
cases and notebooks; checks that every link leads somewhere; runs the commands of the tutorials and the notebooks.

    scripts/docs [--build DIR] [--try] [--notebooks]
"""

from __future__ import annotations

import argparse
import html.parser
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from urllib.parse import unquote, urlsplit

import yaml

ROOT = Path(__file__).resolve().parents[2]
KATEX = Path("/usr/share/javascript/katex")
TRIED = ["docs/start.md", *(f"docs/tutorials/{name}.md" for name in ("triaxial", "own-map", "slope", "tunnel", "study", "calibration"))]
FENCE = re.compile(r'^```(\w+)(?: title="([^"]+)")?\n(.*?)^```$', re.MULTILINE | re.DOTALL)


def fail(message: str) -> None:
    sys.exit(f"docs: {message}")


def tracked_files() -> list[Path]:
    """The files of the project, without what is built."""
    listed = subprocess.run(["git", "ls-files", "--cached", "--others", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True)
    if listed.returncode == 0:
        return [Path(line) for line in listed.stdout.splitlines() if (ROOT / line).is_file()]
    return [path.relative_to(ROOT) for path in ROOT.rglob("*") if path.is_file() and path.relative_to(ROOT).parts[0] != "build"]


def gather(pages: Path) -> None:
    """Pages and what they name, where they stand in the project, so that links between them hold."""
    shutil.rmtree(pages, ignore_errors=True)
    wanted = {".md", ".yaml", ".png", ".svg", ".json", ".csv", ".txt", ".py", ".cff", ".geojson", ""}
    for path in tracked_files():
        if path.parts[0] in {"src", "include", "apps", "tests", "cmake", ".ci"} or path.suffix not in wanted or path.name.startswith("."):
            continue
        if path.parts[:2] in {("docs", "site"), ("docs", "schema")} or path.stat().st_size > 4_000_000:
            continue
        (pages / path).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / path, pages / path)
    for path in pages.rglob("README.md"):
        if path.parent != pages and (path.parent / "index.md").exists():
            path.unlink()
    (pages / "katex").mkdir()
    for name in ("katex.min.css", "katex.min.js"):
        shutil.copy2(KATEX / name, pages / "katex")
    shutil.copytree(KATEX / "fonts", pages / "katex/fonts", symlinks=False)
    for name in ("formulas.js", "formulas.css"):
        shutil.copy2(ROOT / "docs/site" / name, pages / "katex")


def link_folders(pages: Path) -> None:
    """A link to a folder leads to its page, one to a source file nowhere on this site: it becomes plain text."""
    for page in pages.rglob("*.md"):
        def replaced(match: re.Match[str]) -> str:
            label, target = match.groups()
            parts = urlsplit(target)
            if parts.scheme or target.startswith("#"):
                return match.group(0)
            place = page.parent / unquote(parts.path)
            if place.is_dir():
                if (place / "README.md").exists():
                    return f"[{label}]({parts.path.rstrip('/')}/README.md)"
                return label
            return match.group(0) if place.exists() else label

        page.write_text(re.sub(r"(?<!!)\[([^\]]+)\]\(([^)\s]+)\)", replaced, page.read_text(encoding="utf-8")), encoding="utf-8")


def title_of(scene: Path) -> str:
    content = yaml.safe_load(scene.read_text(encoding="utf-8"))
    return str(content.get("title", scene.stem)) if isinstance(content, dict) else scene.stem


def models_page(pages: Path, program: Path) -> None:
    """Every scene of models/ with a picture of its body."""
    lines = ["# Models", "", "Scenes that come with Kluft, drawn by `kluft draw SCENE`.", ""]
    pictures = pages / "gallery/models"
    pictures.mkdir(parents=True)
    for scene in sorted((ROOT / "models").rglob("*.yaml")):
        relative = scene.relative_to(ROOT)
        first = scene.read_text(encoding="utf-8")
        if not re.search(r"^(kluft:|extends:)", first, re.MULTILINE):
            continue  # a study or a calibration
        picture = pictures / (str(relative.with_suffix("")).replace("/", "-") + ".png")
        drawn = subprocess.run([program, "draw", scene, "-o", picture], capture_output=True, text=True)
        if drawn.returncode != 0:
            fail(f"kluft draw {relative}: {drawn.stderr.strip()}")
        lines += [f"## {title_of(scene)}", "", f"[`{relative}`](../{relative})", "", f"![{relative}](models/{picture.name})", ""]
    (pages / "gallery/models.md").write_text("\n".join(lines), encoding="utf-8")


def validation_page(pages: Path) -> None:
    """Every validation case with its question and its figure."""
    lines = ["# Validation", "", "Cases with a closed form or a published result. `kluft validate CASE` runs one.", ""]
    for readme in sorted((ROOT / "validation").glob("*/README.md")):
        text = readme.read_text(encoding="utf-8")
        name = readme.parent.name
        title = text.splitlines()[0].lstrip("# ")
        problem = re.search(r"\*\*(?:Problem|Question)\.\*\*(.*?)(?:\n\n|\Z)", text, re.DOTALL)
        lines += [f"## {title}", "", f"[`validation/{name}`](../validation/{name}/README.md)"]
        if problem:
            lines += ["", problem.group(1).strip()]
        if (readme.parent / "figure.png").exists():
            lines += ["", f"![{title}](../validation/{name}/figure.png)"]
        lines.append("")
    (pages / "gallery/validation.md").write_text("\n".join(lines), encoding="utf-8")


def cells_of(notebook: Path) -> list[tuple[str, str]]:
    """Kind (markdown or code) and text of each cell of a file in the percent format."""
    cells = []
    for part in re.split(r"^# %%", notebook.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]:
        head, _, body = part.partition("\n")
        if "[markdown]" in head:
            cells.append(("markdown", "\n".join(re.sub("^# ?", "", line) for line in body.strip().splitlines())))
        else:
            cells.append(("code", body.strip()))
    return cells


def notebooks_page(pages: Path, build: Path, run: bool) -> None:
    """The notebooks; where they are run, with what they print and draw."""
    folder = pages / "gallery/notebooks"
    folder.mkdir(parents=True, exist_ok=True)
    lines = ["# Notebooks", "", "Python files in the percent format, which Jupyter (with jupytext), VS Code and Spyder open as notebooks.", ""]
    for source in sorted((ROOT / "docs/notebooks").glob("*.py"), key=lambda path: (path.stem != "ten-lines", path.stem)):
        title = cells_of(source)[0][1].splitlines()[0].lstrip("# ")
        page = f"notebooks/{source.stem}.md" if run else f"../docs/notebooks/{source.name}"
        lines.append(f"- [{title}]({page})")
        if run:
            render_notebook(source, folder, build)
    (pages / "gallery/notebooks.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


def render_notebook(source: Path, folder: Path, build: Path) -> None:
    import nbformat
    from nbconvert import MarkdownExporter
    from nbconvert.preprocessors import ExecutePreprocessor

    book = nbformat.v4.new_notebook()
    make = {"markdown": nbformat.v4.new_markdown_cell, "code": nbformat.v4.new_code_cell}
    book.cells = [make[kind](text) for kind, text in cells_of(source)]
    os.environ["PYTHONPATH"] = str(build / "python")
    os.environ["KLUFT_PROGRAM"] = str(build / "kluft")
    os.environ["PYDEVD_DISABLE_FILE_VALIDATION"] = "1"
    os.environ["PYTHONWARNINGS"] = "ignore:the BLAS takes kernels"  # that depends on the machine
    os.environ["MPLBACKEND"] = "module://matplotlib_inline.backend_inline"
    with tempfile.TemporaryDirectory() as directory:
        Path(directory, "models").symlink_to(ROOT / "models")
        ExecutePreprocessor(timeout=300, kernel_name="python3").preprocess(book, {"metadata": {"path": directory}})
    body, resources = MarkdownExporter().from_notebook_node(book)
    for name, content in resources["outputs"].items():
        body = body.replace(f"]({name})", f"]({source.stem}-{name})")
        (folder / f"{source.stem}-{name}").write_bytes(content)
    (folder / f"{source.stem}.md").write_text(body, encoding="utf-8")
    print(f"docs/notebooks/{source.name}: run")


class Links(html.parser.HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.targets: list[str] = []
        self.names: set[str] = set()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name in {"href", "src"} and value:
                self.targets.append(value)
            if name in {"id", "name"} and value:
                self.names.add(value)


def check_links(site: Path) -> int:
    """Throws where a link of a page leads to no file, or to a place that the page has not. Returns the number of links."""
    read = {}
    for page in site.rglob("*.html"):
        read[page.resolve()] = links = Links()
        links.feed(page.read_text(encoding="utf-8"))
    wrong, n_links = [], 0
    for page, links in read.items():
        for target in links.targets:
            parts = urlsplit(target)
            if parts.scheme or parts.netloc or page.name == "404.html":
                continue
            n_links += 1
            file = (page.parent / unquote(parts.path)).resolve() if parts.path else page
            file = file / "index.html" if file.is_dir() else file
            place = unquote(parts.fragment)
            if not file.exists() or (place and file in read and place not in read[file].names and place != "__skip"):
                wrong.append(f"{page.relative_to(site.resolve())}: {target}")
    if wrong:
        fail("links that lead nowhere:\n  " + "\n  ".join(wrong[:40]))
    return n_links


def try_commands(build: Path) -> None:
    """Writes the files that the tutorials show, and runs their commands in order; each page in a directory of its own."""
    environment = {**os.environ, "PATH": f"{build}:{os.environ['PATH']}"}
    for page in TRIED:
        with tempfile.TemporaryDirectory() as directory:
            Path(directory, "models").symlink_to(ROOT / "models")
            for language, title, text in FENCE.findall((ROOT / page).read_text(encoding="utf-8")):
                if title:
                    Path(directory, title).write_text(text, encoding="utf-8")
                elif language == "sh":
                    done = subprocess.run(["bash", "-e", "-c", text], cwd=directory, env=environment, capture_output=True, text=True)
                    if done.returncode != 0:
                        fail(f"{page}: exit code {done.returncode} of\n{text}{done.stderr[-2000:]}")
        print(f"{page}: its commands run")


def main() -> None:
    parser = argparse.ArgumentParser(prog="docs", description="Makes the site of the documents in <build>/site.")
    parser.add_argument("--build", type=Path, default=ROOT / "build/release", help="with the program (default: build/release)")
    parser.add_argument("--try", dest="tried", action="store_true", help="first run the commands of the tutorials")
    parser.add_argument("--notebooks", action="store_true", help="run the notebooks and show what they print and draw")
    words = parser.parse_args()
    build = words.build.resolve()
    program = build / "kluft"
    if not program.exists():
        fail(f"no program {program} (scripts/build)")
    if words.tried:
        try_commands(build)
    work = build / "documents"
    work.mkdir(exist_ok=True)
    pages = work / "pages"
    gather(pages)
    models_page(pages, program)
    validation_page(pages)
    notebooks_page(pages, build, words.notebooks)
    link_folders(pages)
    shutil.copy2(ROOT / "docs/site/mkdocs.yml", work)
    made = subprocess.run([sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "-f", work / "mkdocs.yml", "-d", build / "site"])
    if made.returncode != 0:
        fail("mkdocs found something wrong, see above")
    n_links = check_links(build / "site")
    print(f"{build / 'site' / 'index.html'}: {len(list((build / 'site').rglob('*.html')))} pages, {n_links} links that lead somewhere")


if __name__ == "__main__":
    main()
