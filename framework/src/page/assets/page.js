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

  /** A table that scrolls by itself. Columns: { title, kind }, kind "number", "wide", "cell" or none. Rows: lists of cells, or
   *  { cells, kind }. */
  function table(columns, rows) {
    const cell = (tag, content, column) => h(tag, { class: column && column.kind }, content);
    return h("div", { class: "scroll" }, h("table", null,
      h("thead", null, h("tr", null, columns.map(column => cell("th", column.title, column)))),
      h("tbody", null, rows.map(row => {
        const cells = Array.isArray(row) ? row : row.cells;
        return h("tr", { class: row.kind || null }, cells.map((content, index) => cell("td", content, columns[index])));
      }))));
  }

  // ---- numbers and names as a reader sees them

  const isNumber = value => typeof value === "number" && Number.isFinite(value);
  const significant = (value, digits) => String(Number(value.toPrecision(digits)));
  const number = value => isNumber(value) ? significant(value, 3) : "-";
  function oneDigit(value) {
    return isNumber(value) ? significant(value, 1) : "-";
  }
  const milliseconds = value => !isNumber(value) ? "-" : Math.abs(value) >= 99.95 ? value.toFixed(0) : significant(value, 3);
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
  const soft = text => h("span", { class: "uncertainty" }, text);
  /** Of { value, uncertainty }. */
  const measured = (one, text = number) => !one || !isNumber(one.value) ? "-" : [text(one.value), " ", soft("± " + oneDigit(one.uncertainty))];
  /** Of { median, lower_quartile, upper_quartile, repeats }. */
  const quartiles = time => !time || time.repeats === 0 ? "-"
    : [milliseconds(time.median), " ", soft("[" + milliseconds(time.lower_quartile) + ", " + milliseconds(time.upper_quartile) + "]")];
  const plain = (one, text = number) => !one || !isNumber(one.value) ? "-" : text(one.value) + " ± " + oneDigit(one.uncertainty);

  const shortName = file => file.replace(/^.*\//, "").replace(/\.[^.]*$/, "");
  const words = name => name.replaceAll("_", " ");
  const parametersText = values => Object.entries(values).map(([name, value]) => name + " " + value).join(", ") || "default";
  const outputName = output => output === "whole_image" ? "whole image" : output;
  const componentTitle = name => name === "final" ? "Whole image" : words(name.charAt(0).toUpperCase() + name.slice(1));

  // ---- charts and images

  // A pipeline has one colour on the whole page, and beyond eight of them another shape.
  const palette = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a5195", "#555555"];
  const shapes = ["circle", "triangle", "rect", "rectRot", "star", "crossRot"];
  const pipelines = [...new Set((data.scenes || []).flatMap(scene => scene.points).concat(data.voxels || []).map(record => record.pipeline))];
  function style(pipeline) {
    const index = pipelines.indexOf(pipeline);
    return { colour: palette[index % palette.length], shape: shapes[Math.floor(index / palette.length) % shapes.length] };
  }
  const drawings = [];
  /** A chart that is drawn when the page is shown. `make`: the configuration of Chart.js, asked anew by redraw(). */
  function chart(make, attributes, size) {
    const canvas = h("canvas", attributes);
    const drawing = { draw: () => { drawing.chart = new Chart(canvas, make()); }, redraw() { drawing.chart.destroy(); drawing.draw(); } };
    drawings.push(drawing.draw);
    const frame = h("div", { class: "chart" + (size && size.tall ? " tall" : ""), style: size && size.height ? "height:" + size.height + "px" : null }, canvas);
    return { frame, redraw: drawing.redraw };
  }
  const pngAddress = base64 => "data:image/png;base64," + base64;
  /** Something that is done when the page is shown. */
  const whenShown = work => drawings.push(work);

  function show(...parts) {
    append(document.body, parts);
    drawings.splice(0).forEach(draw => draw());
    // The elements that a link leads to were not there when the page was opened.
    if (location.hash.length > 1) {
      const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
      if (target) target.scrollIntoView();
    }
  }

  return { data, images, h, caption, list, folded, table, isNumber, significant, number, oneDigit, milliseconds, percent, bytes, exposureText, thousands,
           measured, quartiles, plain, shortName, words, parametersText, outputName, componentTitle, palette, style, chart, whenShown,
           pngAddress, show };
})();
