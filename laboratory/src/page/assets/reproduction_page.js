"use strict";
// Published tables and figures, measured here: the cells are those of the Markdown.
(function () {
  const { data, images, h, list, table, pngAddress, show } = lumivox;
  const columns = data.headings.map(title => ({ title, kind: title === "row" || title === "verdict" ? "wide" : "number" }));
  show(h("main", null, h("h1", null, data.title), h("p", null, data.rule), data.results.map((result, index) => {
    const shown = images.results[index];
    return [
      h("h2", null, result.heading), h("p", null, result.paper + ". ", h("strong", null, result.verdict)),
      result.rows.length > 0 && table(columns, result.rows),
      shown.sheet && h("p", null, h("img", { alt: result.title, src: pngAddress(shown.sheet) })),
      shown.curves && h("div", null, h("img", { alt: "curves of " + result.title, src: "data:image/svg+xml;base64," + shown.curves })),
      list([...result.curves, ...result.panels, ...result.claims, ...result.notes])];
  })));
})();
