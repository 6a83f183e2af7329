const byId = (id) => document.getElementById(id);

/** Copies what the element says into the clipboard, also in pages that are opened from a disk. */
function copyText(source, button) {
  const text = source.value ?? source.textContent;
  const done = () => {
    const said = button.textContent;
    button.textContent = "Copied";
    setTimeout(() => { button.textContent = said; }, 1200);
  };
  const bySelection = () => {
    const area = document.createElement("textarea");
    area.value = text;
    document.body.append(area);
    area.select();
    if (document.execCommand("copy")) done();
    area.remove();
    button.focus();
  };
  if (navigator.clipboard && window.isSecureContext) navigator.clipboard.writeText(text).then(done, bySelection);
  else bySelection();
}

for (const button of document.querySelectorAll("button[data-copy]"))
  button.addEventListener("click", () => copyText(byId(button.dataset.copy), button));

/** The number that a cell begins with; NaN where it is a text. */
const numberIn = (text) => (/^\s*[-+]?(\d|\.\d)/.test(text) ? parseFloat(text) : NaN);

/** Sorts the rows by a column: numbers before texts. */
function sortTable(table, column, ascending) {
  const body = table.tBodies[0];
  const keyed = [...body.rows].map((row) => {
    const text = row.cells[column]?.textContent ?? "";
    return { row, text, number: numberIn(text) };
  });
  const compare = (a, b) => {
    if (Number.isNaN(a.number) !== Number.isNaN(b.number)) return Number.isNaN(a.number) ? 1 : -1;
    const order = Number.isNaN(a.number) ? a.text.localeCompare(b.text) : a.number - b.number;
    return ascending ? order : -order;
  };
  body.append(...keyed.sort(compare).map((each) => each.row));
}

for (const table of document.querySelectorAll("table.sortable")) {
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.textContent = head.textContent;
    head.replaceChildren(button);
    button.addEventListener("click", () => {
      const ascending = head.getAttribute("aria-sort") !== "ascending";
      for (const other of heads) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", ascending ? "ascending" : "descending");
      sortTable(table, column, ascending);
    });
  });
}
