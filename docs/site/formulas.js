// Formulas that the Markdown extension has marked, by KaTeX.
document.querySelectorAll(".arithmatex").forEach((element) => {
    const text = element.textContent.trim();
    const shown = text.startsWith("\\[");
    katex.render(text.slice(2, -2), element, { displayMode: shown, throwOnError: false });
});
