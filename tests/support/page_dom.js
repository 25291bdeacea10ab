"use strict";
// Draws a page without a browser: its scripts run on a document with the part of the DOM that the pages use. Prints the result as
// JSON: texts, tables, images, links, charts, controls and problems.
// node page_dom.js page.html
const fs = require("fs"), vm = require("vm");

class Text {
  constructor(text) { this.textContent = String(text); }
  serial() { return this.textContent.replace(/&/g, "&amp;").replace(/</g, "&lt;"); }
}

class Element {
  constructor(tag) {
    this.tagName = tag.toUpperCase();
    this.attributes = {};
    this.children = [];
    this.listeners = {};
    this.className = "";
    if (tag === "canvas") this.calls = [];
  }
  setAttribute(name, value) {
    if (typeof value !== "string") throw new Error(`${this.tagName}: attribute ${name} is a ${typeof value}`);
    this.attributes[name] = value;
    if (name === "class") this.className = value;
    if (name === "value") this.value = value;
    if (name === "width" || name === "height") this[name] = Number(value);
    if (name === "selected" && this.parent) this.parent.value = this.value;
    if (name === "checked") this.checked = true;
  }
  getAttribute(name) { return name in this.attributes ? this.attributes[name] : null; }
  get parentElement() { return this.parent || null; }
  append(...children) {
    for (const child of children) {
      const node = typeof child === "string" ? new Text(child) : child;
      if (!(node instanceof Text) && !(node instanceof Element)) throw new Error(`${this.tagName}: a ${typeof child} is no child`);
      node.parent = this;
      this.children.push(node);
    }
    // The selected choice, or else the first one.
    if (this.tagName === "SELECT" && this.children.length > 0)
      this.value = (this.children.find(one => "selected" in one.attributes) || this.children[0]).attributes.value;
  }
  replaceChildren(...children) {
    this.children = [];
    this.append(...children);
  }
  async click() { for (const listener of this.listeners.click || []) await listener({ target: this }); }
  addEventListener(kind, listener) { (this.listeners[kind] = this.listeners[kind] || []).push(listener); }
  async set(value) {
    if (this.attributes.type === "checkbox") this.checked = value;
    else this.value = value;
    for (const kind of ["input", "change"]) for (const listener of this.listeners[kind] || []) await listener({ target: this });
  }
  get textContent() { return this.children.map(child => child.textContent).join(""); }
  set textContent(text) { this.children = [new Text(text)]; }
  /** The text without hidden elements. */
  get shownText() {
    return this.hidden ? "" : this.children.map(child => child instanceof Element ? child.shownText : child.textContent).join("");
  }
  getContext() {
    const calls = this.calls;
    return new Proxy({}, { get: (state, name) => name in state ? state[name] : (...given) => { calls.push([name, ...given]); },
                           set: (state, name, value) => { state[name] = value; return true; } });
  }
  scrollIntoView() {}
  all(test, found = []) {
    if (test(this)) found.push(this);
    for (const child of this.children) if (child instanceof Element) child.all(test, found);
    return found;
  }
  tag(...names) { return this.all(element => names.includes(element.tagName.toLowerCase())); }
  serial() {
    const attributes = Object.entries(this.attributes).map(([name, value]) => ` ${name}="${value.replace(/&/g, "&amp;").replace(/"/g, "&quot;")}"`);
    const tag = this.tagName.toLowerCase();
    return `<${tag}${attributes.join("")}>${this.children.map(child => child.serial()).join("")}</${tag}>`;
  }
}

async function main(file) {
  const problems = [], html = fs.readFileSync(file, "utf8");
  const blocks = {}, scripts = [];
  for (const [, attributes, text] of html.matchAll(/<script([^>]*)>([^]*?)<\/script>/g)) {
    const id = /id="([^"]*)"/.exec(attributes);
    if (id) blocks[id[1]] = text;
    else scripts.push(text);
  }
  const body = new Element("body"), charts = [];
  const documents = {
    body, createElement: tag => new Element(tag), createElementNS: (space, tag) => new Element(tag),
    getElementById: id => id in blocks ? { textContent: blocks[id] } : body.all(element => element.attributes.id === id)[0] || null };
  class Image {
    async decode() {
      if (!/^data:image\/png;base64,[A-Za-z0-9+/]+=*$/.test(this.src || "")) throw new Error("no image: " + String(this.src).slice(0, 60));
    }
  }
  // The part of Chart.js that the pages use. Chart.js itself needs a real canvas and is not run.
  class Chart {
    constructor(canvas, configuration) {
      Object.assign(this, { canvas, configuration });
      charts.push(this);
    }
    destroy() { charts.splice(charts.indexOf(this), 1); }
  }
  Chart.defaults = { plugins: { legend: { labels: { generateLabels: () => [] } } } };
  const window = { addEventListener() {}, matchMedia: () => ({ matches: false, addEventListener() {} }) };
  const sandbox = vm.createContext({ document: documents, window, location: { hash: "" }, Image: Image, Chart, console });
  const settle = () => new Promise(done => setTimeout(done, 5));
  process.on("unhandledRejection", error => problems.push("script: " + (error && error.message || error)));
  for (const script of scripts) {
    if (/Chart\.js v\d/.test(script.slice(0, 400))) continue;
    try {
      vm.runInContext(script, sandbox);
    } catch (error) {
      problems.push("script: " + error.stack.split("\n").slice(0, 4).join(" "));
    }
  }
  await settle();

  // The names that the plugin writes on a plot of 600 x 400, with linear or logarithmic axes from the least to the largest value.
  const namesAt = ({ data, plugins, options }) => {
    const names = [], plugin = (plugins || []).find(one => one.id === "pointNames");
    const points = data.datasets.filter(set => set.pointRadius !== 0).flatMap(set => set.data);
    const scale = (axis, from, to) => {
      const isLog = options.scales[axis].type === "logarithmic", of = isLog ? Math.log : value => value, values = points.map(point => of(point[axis]));
      const low = Math.min(...values), high = Math.max(...values);
      return { getPixelForValue: value => from + (to - from) * (high > low ? (of(value) - low) / (high - low) : 0.5) };
    };
    const ctx = { save() {}, restore() {}, measureText: text => ({ width: 6 * text.length }),
                  fillText: (text, x, y) => names.push({ text, x, y, width: 6 * text.length }) };
    if (plugin) plugin.afterDatasetsDraw({ ctx, data, isDatasetVisible: () => true, scales: { x: scale("x", 80, 580), y: scale("y", 350, 20) },
                                           chartArea: { left: 50, right: 600, top: 0, bottom: 400 } });
    return names;
  };
  const chartFindings = charts.map(({ canvas, configuration }) => {
    const numbers = configuration.data.datasets.flatMap(set => set.data).map(point => typeof point === "number" ? point : point.y);
    if (numbers.length === 0 || !numbers.every(Number.isFinite)) problems.push("chart " + JSON.stringify(canvas.attributes) + ": its points are no numbers");
    for (const label of configuration.data.datasets.map(set => set.label)) if (!label) problems.push("chart without a label");
    return { ...canvas.attributes, points: numbers.length, labels: configuration.data.datasets.map(set => set.label),
             names: namesAt(configuration) };
  });
  // Every control must change the text, a chart or a canvas.
  const seen = () => JSON.stringify([body.shownText, charts.map(one => [one.configuration.data, one.configuration.options.scales]),
                                     body.tag("canvas").map(canvas => canvas.calls.slice(-8))]);
  const controls = [];
  for (const control of body.tag("select", "input")) {
    const box = control.attributes.type === "checkbox", at = box ? control.checked : control.value;
    const values = box ? [!at] : control.tagName === "INPUT" ? [control.attributes.min, control.attributes.max]
      : control.tag("option").map(option => option.attributes.value).filter(value => value !== at);
    // Drawings are compared by the images that they draw.
    body.tag("canvas").forEach(canvas => { canvas.calls.length = 0; });
    let before = seen(), changed = 0;
    for (const value of values) {
      await control.set(value);
      await settle();
      const after = seen();
      if (after !== before) ++changed;
      before = after;
    }
    await control.set(at);
    await settle();
    if (changed === 0 && values.length > 0) problems.push(`${control.tagName} changes nothing`);
    controls.push({ kind: control.tagName.toLowerCase(), values: values.length, changed });
  }

  // Sorting must change the order of rows, and a second click must reverse it.
  for (const table of body.tag("table")) {
    const order = () => table.tag("tbody")[0].children.map(row => row.textContent).join("\n");
    const buttons = table.tag("button");
    if (buttons.length === 0) continue;
    const before = table.tag("tbody")[0].children.slice(), orders = new Set();
    for (const button of buttons) for (let press = 0; press < 2; ++press) {
      await button.click();
      orders.add(order());
    }
    if (orders.size === 1 && new Set(before.map(row => row.textContent)).size > 1) problems.push("sorting changes nothing: " + order().slice(0, 60));
    table.tag("tbody")[0].replaceChildren(...before);
  }

  const tables = body.tag("table").map(table => {
    const rows = table.tag("tr").map(row => row.children.map(cell => cell.textContent));
    if (rows.length < 2) problems.push("a table has no rows: " + rows.join());
    const width = row => row.tag("th", "td").reduce((sum, cell) => sum + Number(cell.attributes.colspan || 1), 0);
    const widths = [...new Set(table.tag("tr").map(width))];
    if (widths.length > 1) problems.push("rows of a table have " + widths.join(" and ") + " cells: " + rows[0].join(" | "));
    for (const cell of table.tag("td").map(one => one.textContent))
      if (/undefined|\[object|^NaN$|^NaN [^,]|^null$|Infinity/.test(cell)) problems.push("a cell says " + cell);
    return rows;
  });
  const ids = body.all(element => "id" in element.attributes).map(element => element.attributes.id);
  for (const id of ids) if (ids.indexOf(id) !== ids.lastIndexOf(id)) problems.push("two elements are called " + id);
  const links = body.tag("a").map(link => link.attributes.href);
  for (const href of links)
    if (href && href.startsWith("#") && !ids.includes(href.slice(1))) problems.push("a link leads nowhere: " + href);
  // Plots to save must be well-formed SVG.
  const svgs = links.filter(href => href && href.startsWith("data:image/svg+xml")).map(href => decodeURIComponent(href.slice(href.indexOf(",") + 1)));
  for (const svg of svgs) {
    const open = [];
    for (const [, end, tag, , single] of svg.matchAll(/<(\/?)([a-zA-Z]+)((?:\s+[a-zA-Z0-9-]+="[^"<]*")*)(\/?)>/g))
      if (end) { if (open.pop() !== tag) problems.push("SVG: " + tag + " ends where it did not begin"); }
      else if (!single) open.push(tag);
    if (open.length > 0 || svg.replace(/<\/?[a-zA-Z]+(\s+[a-zA-Z0-9-]+="[^"<]*")*\/?>/g, "").includes("<")) problems.push("SVG: not well formed");
    if (/NaN|undefined|Infinity/.test(svg)) problems.push("SVG: " + /.{0,60}(NaN|undefined|Infinity)/.exec(svg)[0]);
  }
  const images = body.tag("img").map(image => image.attributes);
  for (const image of images)
    if (!image.alt || !image.src) problems.push("an image without a text or an address");
  const slip = /.{0,40}(undefined|\[object Object\]).{0,40}/.exec(body.textContent);
  if (slip) problems.push("the text says " + slip[0]);
  process.stdout.write(JSON.stringify({ problems, text: body.textContent, html: body.serial(), tables, links, svgs, charts: chartFindings, controls,
                                        images: images.map(({ alt, src }) => ({ alt, src: src.slice(0, 40) })),
                                        headings: body.tag("h1", "h2", "h3", "h4").map(heading => heading.textContent) }));
}

main(process.argv[2]).catch(error => { process.stderr.write(error.stack + "\n"); process.exitCode = 1; });
