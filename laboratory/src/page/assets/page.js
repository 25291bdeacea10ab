"use strict";
// The basis of every page: its records, elements, texts of numbers, tables and charts. A page is built as elements before it is shown, and
// texts go in as texts, so that nothing in a record can be taken for markup.
const lumivox = (function () {
  const records = id => {
    const block = document.getElementById(id);
    return block ? JSON.parse(block.textContent) : null;
  };
  const data = records("data") || {};
  const images = records("images") || {};

  // ---- elements

  function append(element, child) {
    if (child === null || child === undefined || child === false) return;
    if (Array.isArray(child)) child.forEach(one => append(element, one));
    else element.append(typeof child === "number" ? String(child) : child);
  }
  /** An element with attributes and children: texts, elements, lists of both; nothing where null. */
  function h(tag, attributes, ...children) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes || {})) {
      if (value === null || value === undefined || value === false) continue;
      element.setAttribute(name, value === true ? "" : String(value));
    }
    append(element, children);
    return element;
  }
  const caption = (...children) => h("p", { class: "caption" }, ...children);
  const list = items => h("ul", null, items.map(item => h("li", null, item)));
  const folded = (title, ...children) => h("details", null, h("summary", null, title), ...children);
  const plural = (count, one, many) => count + " " + (count === 1 ? one : many || one + "s");
  /** The title of something folded, with how much there is of it: "Which ones: 119 points". */
  const counted = (title, count, one, many) => title + ": " + (one ? plural(count, one, many) : count);
  /** A list below its title, folded where it is long. */
  const longList = (title, items, one, many) => items.length > 10 ? folded(counted(title, items.length, one, many), list(items))
    : [h("p", null, title + ":"), list(items)];
  /** A section that opens when a link leads to it. */
  const section = (id, title, ...children) => h("details", { class: "section", id }, h("summary", null, h("h3", null, title)), ...children);
  /** A list to choose from, with its label; null: there is nothing to choose. `choices`: texts by value. */
  function chooser(label, kind, choices, chosen, changed) {
    if (Object.keys(choices).length < 2) return null;
    const select = h("select", { "data-choose": kind }, Object.entries(choices).map(([value, title]) =>
      h("option", { value, selected: value === chosen }, title)));
    select.addEventListener("change", () => changed(select.value));
    return h("label", null, label + " ", select);
  }

  // ---- tables

  /** A cell that is sorted by a number or text of its own. */
  const sortedBy = (value, show) => ({ value, show });
  const isSorted = cell => cell !== null && typeof cell === "object" && "show" in cell;

  /** A table that is sorted by its heads and, where it is long, filtered by pipeline and by points, and whose columns can be
   *  hidden. In a narrow window its rows are cards. Columns: { title, kind, hidden }, kind "number", "wide" or none. Rows: lists of
   *  cells, or { cells, kind, pipeline, isDefault }. */
  function table(columns, rows) {
    const body = h("tbody");
    // Default points stand out where there are others.
    const mixed = rows.some(row => row.isDefault === false);
    const lines = rows.map((row, at) => {
      const { cells, kind, pipeline, isDefault } = Array.isArray(row) ? { cells: row } : row;
      const line = h("tr", { class: (kind === "default" && isDefault && !mixed ? null : kind) || null }, cells.map((cell, index) =>
        h("td", { class: columns[index].kind, "data-title": columns[index].title }, isSorted(cell) ? cell.show : cell)));
      const keys = cells.map((cell, index) => isSorted(cell) ? cell.value : line.children[index].textContent);
      return { line, keys, at, pipeline, isDefault };
    });
    const chosen = { pipeline: "", points: "all" };
    const heads = columns.map((column, index) => {
      if (rows.length < 2) return h("th", { class: column.kind, scope: "col" }, column.title);
      const button = h("button", { type: "button", title: "sort by this column" }, column.title);
      const head = h("th", { class: column.kind, scope: "col", "aria-sort": "none" }, button);
      button.addEventListener("click", () => {
        const direction = head.getAttribute("aria-sort") === "ascending" ? "descending" : "ascending";
        heads.forEach(other => other.setAttribute("aria-sort", other === head ? direction : "none"));
        sort(index, direction === "ascending" ? 1 : -1);
      });
      return head;
    });
    // What has no number stands last either way.
    function sort(index, sign) {
      const none = key => key === null || key === undefined || key === "" || key === "-";
      lines.sort((a, b) => {
        const x = a.keys[index], y = b.keys[index];
        if (none(x) || none(y)) return none(x) - none(y) || a.at - b.at;
        const numbers = [x, y].map(key => typeof key === "number" ? key : parseFloat(key));
        return sign * (numbers.some(Number.isNaN) ? String(x).localeCompare(String(y), undefined, { numeric: true }) : numbers[0] - numbers[1])
          || a.at - b.at;
      });
      body.replaceChildren(...lines.map(line => line.line));
    }
    const filter = () => lines.forEach(one => {
      one.line.hidden = (chosen.pipeline !== "" && one.pipeline !== chosen.pipeline) || (chosen.points === "default" && !one.isDefault);
    });
    function hide(index, isHidden) {
      heads[index].hidden = isHidden;
      lines.forEach(one => { one.line.children[index].hidden = isHidden; });
    }
    columns.forEach((column, index) => { if (column.hidden) hide(index, true); });
    body.replaceChildren(...lines.map(line => line.line));

    const tools = [], inTable = [...new Set(lines.map(one => one.pipeline).filter(Boolean))];
    if (inTable.length > 1 && lines.length > 8)
      tools.push(chooser("Pipeline", "pipeline", { "": "all", ...Object.fromEntries(inTable.map(file => [file, shortName(file)])) }, "",
                         value => { chosen.pipeline = value; filter(); }));
    const defaults = lines.filter(one => one.isDefault).length;
    if (defaults > 0 && defaults < lines.length && lines.length > 8)
      tools.push(chooser("Points", "points", { all: "all", default: "default parameters" }, "all", value => { chosen.points = value; filter(); }));
    if (columns.some(column => column.hidden) || (columns.length > 6 && lines.length > 8))
      tools.push(h("details", { class: "columns" }, h("summary", null, "Columns"), h("div", null, columns.map((column, index) => {
        const box = h("input", { type: "checkbox", checked: !column.hidden });
        box.addEventListener("change", () => hide(index, !box.checked));
        return h("label", null, box, " " + column.title);
      }))));
    return h("div", { class: "table" }, tools.length > 0 && h("div", { class: "tools" }, tools),
             h("table", { class: "data" }, h("thead", null, h("tr", null, heads)), body));
  }

  // ---- numbers and names as a reader sees them

  const isNumber = value => typeof value === "number" && Number.isFinite(value);
  const significant = (value, digits) => String(Number(value.toPrecision(digits)));
  const number = value => isNumber(value) ? significant(value, 3) : "-";
  const oneDigit = value => isNumber(value) ? significant(value, 1) : "-";
  const milliseconds = value => !isNumber(value) ? "-" : Math.abs(value) >= 99.95 ? value.toFixed(0)
    : Math.abs(value) >= 1e-3 ? value.toPrecision(3) : significant(value, 3);
  const percent = share => isNumber(share) ? (100 * share).toFixed(1) + " %" : "-";
  /** At which a scene's images are shown: "exposure -1.25 EV (log-average of the full reference)". */
  const exposureText = scene => scene.reference.exposure_ev === null ? "an unknown exposure"
    : `exposure ${scene.reference.exposure_ev.toFixed(2)} EV (${scene.reference.exposure_from})`;
  function bytes(count) {
    if (!isNumber(count)) return "-";
    const units = ["B", "KiB", "MiB", "GiB", "TiB"];
    let unit = 0;
    for (; count >= 1024 && unit + 1 < units.length; ++unit) count /= 1024;
    return (unit === 0 ? String(count) : count.toFixed(1)) + " " + units[unit];
  }
  function thousands(value) {
    const prefixes = ["", " k", " M", " G", " T", " P"];
    let power = 0;
    for (; value >= 999.5 && power + 1 < prefixes.length; ++power) value /= 1000;
    return significant(value, 3) + prefixes[power];
  }
  /** As many digits as the uncertainty lets stand, two at least and four at most. */
  function sure(value, uncertainty) {
    if (!isNumber(value) || value === 0 || !(uncertainty > 0)) return number(value);
    const digits = Math.floor(Math.log10(Math.abs(value))) - Math.floor(Math.log10(uncertainty)) + 1;
    const text = value.toPrecision(Math.min(4, Math.max(2, digits)));
    return text.includes("e") ? significant(value, Math.min(4, Math.max(2, digits))) : text;
  }
  const soft = text => h("span", { class: "uncertainty" }, text);
  /** Of { value, uncertainty }. */
  const measured = (one, text) => !one || !isNumber(one.value) ? "-"
    : [text ? text(one.value) : sure(one.value, one.uncertainty), " ", soft("± " + oneDigit(one.uncertainty))];
  /** Of { median, lower_quartile, upper_quartile, repeats }; two frames or one have no quartiles. */
  const hasQuartiles = time => time.repeats >= 3;
  const quartiles = time => !time || time.repeats === 0 ? "-" : !hasQuartiles(time) ? milliseconds(time.median)
    : [milliseconds(time.median), " ", soft("[" + milliseconds(time.lower_quartile) + ", " + milliseconds(time.upper_quartile) + "]")];
  const plain = one => !one || !isNumber(one.value) ? "-" : sure(one.value, one.uncertainty) + " ± " + oneDigit(one.uncertainty);

  const shortName = file => file.replace(/^.*\//, "").replace(/\.[^.]*$/, "");
  /** A name that may be broken at its underscores. */
  const broken = name => name.split("_").flatMap((part, index) => index === 0 ? [part] : ["_", h("wbr"), part]);
  const pipelineName = file => broken(shortName(file));
  const words = name => name.replaceAll("_", " ");
  const parametersText = values => Object.entries(values).map(([name, value]) => name + " " + value).join(", ") || "default";
  const outputName = output => output === "whole_image" ? "whole image" : output;
  const componentTitle = name => name === "final" ? "Whole image" : words(name.charAt(0).toUpperCase() + name.slice(1));
  /** "a, b and c". */
  const listed = texts => texts.length < 2 ? texts.join("") : texts.slice(0, -1).join(", ") + " and " + texts[texts.length - 1];

  // ---- colours

  // A pipeline has one colour and one shape on the whole page; both change from one to the next, so that neither has to be told
  // apart alone (Okabe and Ito's colours, lighter ones on a dark page).
  const colours = { light: ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b37700", "#56b4e9", "#7a5195", "#555555"],
                    dark: ["#56a9e8", "#ff8a4c", "#2fc79a", "#e39fc6", "#f0c04c", "#a5dcff", "#b79be0", "#b5b5b5"] };
  const shapes = ["circle", "triangle", "rect", "rectRot", "star"];
  const pipelines = [...new Set((data.scenes || []).flatMap(scene => scene.points).concat(data.voxels || []).map(record => record.pipeline))];
  const darkWanted = window.matchMedia("(prefers-color-scheme: dark)");
  let printing = false;
  const theme = () => darkWanted.matches && !printing
    ? { lines: colours.dark, ink: "#e4e8ee", soft: "#9fabba", grid: "#323a46", paper: "#14181e", band: "#ffffff24" }
    : { lines: colours.light, ink: "#1d2430", soft: "#5b6676", grid: "#dfe4ea", paper: "#ffffff", band: "#0000001c" };
  function style(pipeline) {
    const index = pipelines.indexOf(pipeline), { lines } = theme();
    return { colour: lines[index % lines.length], shape: shapes[index % shapes.length], index };
  }
  // A key outside of the charts.
  function swatch(pipeline) {
    const { shape, index } = style(pipeline);
    const [drawing, path] = ["svg", "path"].map(tag => document.createElementNS("http://www.w3.org/2000/svg", tag));
    for (const [name, value] of Object.entries({ class: "swatch line-" + index % colours.light.length, viewBox: "0 0 14 14", "aria-hidden": "true" }))
      drawing.setAttribute(name, value);
    path.setAttribute("d", plots.outlines[shape]);
    drawing.append(path);
    return drawing;
  }

  // ---- charts and images

  const drawings = [], redrawn = [];
  /** A chart that is drawn when the page is shown. `make`: the configuration of Chart.js, asked anew by redraw(). Arrow keys move
   *  from point to point, and the line below tells the point: its `text`. */
  function chart(make, attributes, label) {
    const canvas = h("canvas", { role: "img", tabindex: 0, "aria-label": label + ". Arrow keys move from point to point.", ...attributes });
    const told = h("p", { class: "told", "aria-live": "polite" });
    const save = h("a", { class: "save", download: "lumivox_" + label.toLowerCase().replace(/[^a-z0-9]+/g, "_") + ".svg" }, "Save as SVG");
    let drawn = null, at = -1;
    /** The plot as a file for a paper, which is white. */
    function onPaper(make) {
      const before = printing;
      printing = true;
      try { return plots.svgOf(make()); } finally { printing = before; }
    }
    const draw = () => {
      const svg = onPaper(make);
      if (svg !== null) save.setAttribute("href", "data:image/svg+xml;charset=utf-8," + encodeURIComponent(svg));
      save.hidden = svg === null;
      const { ink, grid } = theme();
      Chart.defaults.color = ink;
      Chart.defaults.borderColor = grid;
      drawn = new Chart(canvas, make());
    };
    const redraw = () => { if (drawn) { drawn.destroy(); told.textContent = ""; at = -1; draw(); } };
    canvas.addEventListener("keydown", event => {
      const step = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
      if (!step && event.key !== "Escape") return;
      event.preventDefault();
      const points = drawn.data.datasets.flatMap((set, datasetIndex) => set.data.map((point, index) => ({ datasetIndex, index, set, point })))
        .filter(one => one.point.text !== undefined && drawn.isDatasetVisible(one.datasetIndex));
      at = !step || points.length === 0 ? -1 : (at + step + points.length) % points.length;
      const active = at < 0 ? [] : [points[at]];
      const place = at < 0 ? { x: 0, y: 0 } : drawn.getDatasetMeta(active[0].datasetIndex).data[active[0].index];
      drawn.setActiveElements(active);
      drawn.tooltip.setActiveElements(active, { x: place.x, y: place.y });
      drawn.update();
      told.textContent = at < 0 ? "" : points[at].set.label + ", " + points[at].point.text;
    });
    drawings.push(draw);
    redrawn.push(redraw);
    return { frame: [h("div", { class: "chart" }, canvas), told, save], redraw };
  }
  const pngAddress = base64 => "data:image/png;base64," + base64;
  /** Something that is done when the page is shown. */
  const whenShown = work => drawings.push(work);

  /** Opens the sections around the element that the address names, and goes there. */
  function goToAddress() {
    if (location.hash.length < 2) return;
    const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
    if (!target) return;
    for (let place = target; place; place = place.parentElement) if (place.tagName === "DETAILS") place.open = true;
    target.scrollIntoView();
  }

  function show(...parts) {
    append(document.body, parts);
    drawings.splice(0).forEach(draw => draw());
    const redrawAll = () => redrawn.forEach(redraw => redraw());
    darkWanted.addEventListener("change", redrawAll);
    // What is folded is printed too, on white.
    window.addEventListener("beforeprint", () => {
      document.querySelectorAll("details:not(.columns)").forEach(one => { one.open = true; });
      printing = true;
      redrawAll();
    });
    window.addEventListener("afterprint", () => { printing = false; redrawAll(); });
    window.addEventListener("hashchange", goToAddress);
    // The elements that a link leads to were not there when the page was opened.
    goToAddress();
  }

  return { data, images, h, caption, list, longList, folded, plural, counted, section, chooser, table, sortedBy, isNumber, significant, number,
           oneDigit, milliseconds, percent, bytes, exposureText, thousands, measured, quartiles, hasQuartiles, plain, soft, shortName, broken, pipelineName, words,
           parametersText, outputName, componentTitle, listed, style, theme, swatch, chart, whenShown, pngAddress, show };
})();
