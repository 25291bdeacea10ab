"use strict";
// Where each technique breaks: the matrix of pipelines and cases, the cells that are not stable, and those that are. `images`: the
// folder beside the page that holds the cells' images; empty: no links.
const stressSection = (function () {
  const { h, caption, table, isNumber, number, measured, shortName, pipelineName, words } = lumivox;
  // In the order of concern.
  const outcomes = {
    broken: "NaN, infinite or negative where it must not be, a crash or a hang",
    diverges: "finite, but it grows without bound or does not converge where it should",
    biased: "healthy and bounded, but beyond the limit of the case",
    refused: "a clear message in place of an image",
    stable: "healthy, and within the limit of the case",
    not_applicable: "the case asks for something that the pipeline does not have" };
  const hasNumber = cell => cell.measure !== "" && ["diverges", "biased", "stable"].includes(cell.outcome);
  const unit = cell => cell.unit ? " " + cell.unit : "";

  /** Each once; neighbours of one head stand together, in the order of their first ones. */
  function axis(cells, head, name) {
    const groups = new Map();
    for (const cell of cells) groups.set(cell[head], (groups.get(cell[head]) || new Set()).add(cell[name]));
    return [...groups].map(([group, names]) => ({ group, names: [...names] }));
  }

  /** The matrix, in blocks of as many columns as fit: each names the cases again. */
  function matrix(cells) {
    const cases = axis(cells, "family", "case");
    const pipelines = axis(cells, "technique", "pipeline").flatMap(one => one.names.map(name => ({ technique: one.group, name })));
    const at = (name, pipeline) => cells.findLastIndex(cell => cell.case === name && cell.pipeline === pipeline);
    // Long units are in the title, so that a dozen columns fit.
    const brief = cell => cell.unit.length > 3 ? "" : unit(cell);
    const short = value => isNumber(value) && value !== 0 && Math.abs(value) < 1e-3 ? value.toExponential(1) : number(value);
    const text = cell => cell.outcome === "not_applicable" ? "" : hasNumber(cell) ? short(cell.value) + brief(cell) : words(cell.outcome);
    const place = (name, pipeline) => {
      const index = at(name, pipeline), cell = cells[index];
      if (!cell) return h("td", null);
      const value = cell.outcome + (hasNumber(cell) ? " " + (isNumber(cell.value) ? number(cell.value) : "-") + unit(cell) : "");
      return h("td", { class: "cell " + cell.outcome, title: shortName(pipeline) + ", " + name + ": " + value + (cell.measure ? "; " + cell.measure : "") },
               text(cell) && h("a", { href: "#cell-" + index }, text(cell)));
    };
    const heads = part => part.filter((one, i) => i === 0 || one.technique !== part[i - 1].technique).map(one =>
      h("th", { class: "group", colspan: part.filter(other => other.technique === one.technique).length }, words(one.technique)));
    const block = part => h("table", { class: "stress" },
      // Names of the columns stand upright, so that a dozen and more fit.
      h("thead", null, h("tr", null, h("th", null), heads(part)),
        h("tr", null, h("th", null, "case"), part.map(one => h("th", { class: "upright" }, h("span", null, words(shortName(one.name))))))),
      h("tbody", null, cases.map(family => [
        h("tr", { class: "family" }, h("th", { colspan: part.length + 1 }, words(family.group))),
        family.names.map(name => h("tr", null, h("td", { class: "case" }, words(name)), part.map(one => place(name, one.name))))])));
    const whole = h("div", { class: "matrix", role: "region", "aria-label": "pipelines and cases" });
    let columns = 0;
    const fit = width => {
      // The case beside its columns and the page's margins, CSS pixels; blocks of about the same number of columns.
      const fitting = Math.max(2, Math.floor((width - (width > 900 ? 240 : 150)) / 66));
      const wanted = Math.ceil(pipelines.length / Math.max(1, Math.ceil(pipelines.length / fitting)));
      if (wanted === columns) return;
      columns = wanted;
      const blocks = [];
      for (let from = 0; from < pipelines.length; from += columns) blocks.push(block(pipelines.slice(from, from + columns)));
      whole.replaceChildren(...blocks);
    };
    const paper = 700;
    const fitWindow = () => fit(Math.min(window.innerWidth || 1400, 1500));
    fitWindow();
    window.addEventListener("resize", fitWindow);
    window.addEventListener("beforeprint", () => fit(paper));
    window.addEventListener("afterprint", fitWindow);
    return whole;
  }

  const legend = cells => h("table", { class: "stress legend" }, h("tbody", null, Object.entries(outcomes).map(([outcome, meaning]) =>
    h("tr", null, h("td", { class: "cell " + outcome }, words(outcome)),
      h("td", { class: "number" }, cells.filter(cell => cell.outcome === outcome).length), h("td", null, meaning)))));

  const measureText = cell => cell.measure === "" ? null
    : [cell.measure + ": ", h("b", null, measured(cell)), unit(cell) + (cell.limit > 0 ? "; limit " + number(cell.limit) : "")];

  const concern = (cell, index, images) => h("section", { class: "concern", id: "cell-" + index },
    images && cell.image && h("a", { href: cell.image }, h("img", { alt: "image of the cell", src: cell.image, loading: "lazy" })),
    h("h4", null, h("span", { class: "cell " + cell.outcome }, words(cell.outcome)), " " + shortName(cell.pipeline) + ": " + words(cell.case)),
    measureText(cell) && h("p", null, measureText(cell)), cell.detail && h("p", { class: "soft" }, cell.detail),
    cell.explanation && h("p", null, cell.explanation), h("pre", null, cell.command));

  return function (cells, images) {
    const quiet = ["stable", "not_applicable"];
    const concerns = Object.keys(outcomes).filter(outcome => !quiet.includes(outcome)).flatMap(outcome =>
      cells.map((cell, index) => cell.outcome === outcome ? concern(cell, index, images) : null).filter(Boolean));
    const stable = cells.map((cell, index) => ({ cell, index })).filter(({ cell }) => cell.outcome === "stable");
    return [
      caption("Every pipeline on every extreme case. A cell holds what its case measures; its colour is the outcome. Each leads to its "
        + "image and to the command that repeats it."),
      legend(cells), matrix(cells), h("h3", null, "Cells that are not stable"), concerns.length > 0 ? concerns : h("p", null, "There are none."),
      h("h3", null, "Stable cells"),
      table([{ title: "Pipeline" }, { title: "Case" }, { title: "Measured", kind: "wide" }, { title: "Detail", kind: "wide" },
             { title: "Image" }, { title: "Command", kind: "wide" }],
        stable.map(({ cell, index }) => ({ pipeline: cell.pipeline, cells: [
          [h("span", { id: "cell-" + index }), pipelineName(cell.pipeline)], words(cell.case), measureText(cell), cell.detail,
          images && cell.image ? h("a", { href: cell.image }, "image") : "", h("code", null, cell.command)] })))];
  };
})();
