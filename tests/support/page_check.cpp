#include "support/page_check.h"

#include <algorithm>
#include <limits>
#include <regex>

#include "lumivox/base/file.h"

namespace lumivox::test {
namespace {

// Sizes in CSS pixels: the first screen of a desktop, a tablet, a phone of a common size, and A4 between
// margins of 1 cm.
constexpr int kDesk[] = {1400, 900}, kTablet[] = {800, 900}, kPhone[] = {390, 844}, kPaper[] = {718, 1000};

/// Measures the page as it opens.
constexpr const char* kFirstScreen = R"js(
(async () => {
  await new Promise(done => requestAnimationFrame(() => setTimeout(done, 50)));
  const ends = selector => {
    const first = [...document.querySelectorAll(selector)].find(one => one.getBoundingClientRect().height > 0);
    return first ? first.getBoundingClientRect().bottom + scrollY : null;
  };
  return { height: document.documentElement.scrollHeight, chart: ends(".chart"), image: ends("img") };
})()
)js";

/// Runs in the page and returns its findings.
constexpr const char* kProbe = R"js(
(async () => {
  const found = { canvases: 0, charts: 0, tables: 0, rows: 0, images: 0, controls: [], files: [], links: 0, problems: [] };
  const wrong = (element, what) => found.problems.push(name(element) + ": " + what);
  const name = element => element.tagName.toLowerCase() + [...element.attributes]
    .filter(one => /^(id|class|data-.*|aria-label|alt)$/.test(one.name)).map(one => " " + one.name + "=" + one.value.slice(0, 60)).join("");
  const frames = () => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 30))));
  const isShown = element => element.closest("[hidden]") === null;
  for (const details of document.querySelectorAll("details")) details.open = true;
  await frames();

  const canvases = [...document.querySelectorAll("canvas")];
  const pixels = canvas => canvas.width * canvas.height === 0 ? new Uint32Array(0)
    : new Uint32Array(canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.buffer);
  const isBlank = canvas => {
    const values = pixels(canvas);
    let other = 0;
    for (const value of values) other += value !== values[0];
    return other < 0.002 * values.length || values.length === 0;
  };
  // Images are decoded beside the script; a busy machine takes its time.
  for (let wait = 0; wait < 100 && canvases.some(canvas => isShown(canvas) && isBlank(canvas)); ++wait)
    await new Promise(resolve => setTimeout(resolve, 100));
  for (const canvas of canvases) {
    if (!isShown(canvas)) continue;
    ++found.canvases;
    if (isBlank(canvas)) wrong(canvas, "it is blank");
    const chart = window.Chart && Chart.getChart(canvas);
    if (!chart) continue;
    ++found.charts;
    const { left, right, top, bottom } = chart.chartArea;
    const inside = chart.data.datasets.flatMap((set, index) => chart.getDatasetMeta(index).data)
      .filter(one => one.x >= left - 1 && one.x <= right + 1 && one.y >= top - 1 && one.y <= bottom + 1);
    if (inside.length === 0) wrong(canvas, "its chart has no point within its axes");
  }

  // The visible effect of a control: the text of the page and the pixels of the canvases around it.
  const around = control => {
    let place = control;
    while (place !== document.body && place.querySelector("canvas") === null) place = place.parentElement;
    return canvases.filter(canvas => place.contains(canvas));
  };
  const seen = near => ({ text: document.body.innerText, pixels: near.map(pixels) });
  const difference = (a, b) => {
    let count = 0;
    a.pixels.forEach((values, at) => {
      const others = b.pixels[at];
      if (values.length !== others.length) count += Math.max(values.length, others.length);
      else values.forEach((value, index) => { count += value !== others[index]; });
    });
    return { pixels: count, any: count > 0 || a.text !== b.text };
  };
  const set = async (control, value) => {
    control.value = value;
    control.dispatchEvent(new Event("input", { bubbles: true }));
    control.dispatchEvent(new Event("change", { bubbles: true }));
    await frames();
  };
  for (const control of document.querySelectorAll("input[type=range], select")) {
    if (!isShown(control)) continue;
    const slider = control.tagName === "INPUT", at = control.value;
    const values = slider ? [control.min || "0", control.max || "100"] : [...control.options].map(one => one.value).filter(value => value !== at);
    const near = around(control);
    let before = seen(near), changed = 0, idle = [];
    // Of a long list some choices stand for all.
    const tried = values.length > 8 ? [values[0], values[Math.floor(values.length / 2)], values[values.length - 1]] : values;
    for (const value of tried) {
      await set(control, value);
      const after = seen(near), change = difference(before, after);
      if (!change.any) idle.push(value);
      changed = Math.max(changed, change.pixels);
      before = after;
    }
    await set(control, at);
    if (slider ? idle.length > 0 : idle.length === tried.length) wrong(control, "it changes nothing at " + idle.join(", "));
    found.controls.push({ name: name(control), slider, changed });
  }

  for (const box of document.querySelectorAll("input[type=checkbox]")) {
    const table = box.closest(".table"), before = table.innerText;
    box.click();
    if (table.innerText === before) wrong(box, "it changes nothing");
    box.click();
    if (table.innerText !== before) wrong(box, "twice is not as before");
  }
  for (const table of document.querySelectorAll("table")) {
    const buttons = [...table.querySelectorAll("th button")].filter(one => one.offsetWidth > 0);
    const order = () => [...table.tBodies[0].rows].map(row => row.textContent).join("\n");
    if (buttons.length === 0 || new Set(order().split("\n")).size < 2) continue;
    const orders = new Set([order()]);
    for (const button of buttons.slice(0, 3)) for (let press = 0; press < 2; ++press) {
      button.click();
      orders.add(order());
      if (!/^(a|de)scending$/.test(button.closest("th").getAttribute("aria-sort"))) wrong(button, "its head does not say how it sorts");
    }
    if (orders.size < 2) wrong(table, "its heads do not sort");
  }
  for (const canvas of canvases) {
    if (!isShown(canvas) || !(window.Chart && Chart.getChart(canvas)) || !canvas.hasAttribute("tabindex")) continue;
    const told = canvas.closest(".chart").nextElementSibling;
    canvas.focus();
    canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight", bubbles: true, cancelable: true }));
    const first = told && told.textContent;
    canvas.dispatchEvent(new KeyboardEvent("keydown", { key: "Escape", bubbles: true, cancelable: true }));
    if (document.activeElement !== canvas || !first || told.textContent !== "") wrong(canvas, "arrow keys do not tell its points");
  }
  for (const one of document.querySelectorAll("canvas, input, select, button")) {
    const label = one.labels && one.labels.length ? one.labels[0].textContent : "";
    if (!(one.getAttribute("aria-label") || label.trim() || (one.tagName === "BUTTON" && one.textContent.trim())))
      wrong(one, "it has no name for a screen reader");
  }

  for (const table of document.querySelectorAll("table")) {
    ++found.tables;
    const rows = table.tBodies.length ? [...table.tBodies].reduce((sum, body) => sum + body.rows.length, 0) : 0;
    found.rows += rows;
    if (rows === 0) wrong(table, "it has no rows");
    for (const cell of table.querySelectorAll("td"))
      if (/undefined|\[object|^NaN$|^null$/.test(cell.textContent)) wrong(cell, "it says " + cell.textContent.slice(0, 60));
  }
  for (const image of document.images) {
    ++found.images;
    await image.decode().catch(() => {});
    if (image.naturalWidth === 0) wrong(image, "the image does not show");
  }
  for (const link of document.querySelectorAll("a[href]")) {
    ++found.links;
    const href = link.getAttribute("href");
    if (href.startsWith("#")) {
      if (href.length > 1 && document.getElementById(decodeURIComponent(href.slice(1))) === null) wrong(link, "it leads nowhere: " + href);
    } else if (!/^[a-z]+:/i.test(href)) {
      found.files.push(decodeURIComponent(href.replace(/[?#].*$/, "")));
    }
  }
  return found;
})()
)js";

/// The element that exceeds the window's width the most without scrolling by itself, or nothing. Charts adapt
/// to the window some frames later.
constexpr const char* kOverflow = R"js(
(async () => {
  const isWide = () => document.documentElement.scrollWidth > document.documentElement.clientWidth;
  for (let frame = 0; frame < 60 && (frame < 3 || isWide()); ++frame) await new Promise(done => setTimeout(done, 25));
  if (!isWide()) return "";
  const width = document.documentElement.clientWidth;
  let widest = document.body, right = 0;
  for (const element of document.body.querySelectorAll("*")) {
    let scrolls = false;
    for (let parent = element.parentElement; parent && parent !== document.body; parent = parent.parentElement)
      scrolls = scrolls || getComputedStyle(parent).overflowX !== "visible";
    const edge = element.getBoundingClientRect().right;
    if (!scrolls && edge > right) { widest = element; right = edge; }
  }
  return document.documentElement.scrollWidth + " pixels in a window of " + width + ", by " + widest.tagName.toLowerCase()
    + "." + widest.className + " up to " + Math.round(right);
})()
)js";

/// Finds texts and images that overlap, and texts that are cut off.
constexpr const char* kLayout = R"js(
(() => {
  scrollTo(0, 0);
  const problems = [], boxes = [];
  const words = text => text.trim().replace(/\s+/g, " ").slice(0, 40);
  const isSeen = element => element.checkVisibility({ visibilityProperty: true, opacityProperty: true });
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const parent = node.parentElement;
    if (!node.data.trim() || /^(SCRIPT|STYLE|OPTION|NOSCRIPT)$/.test(parent.tagName) || !isSeen(parent)) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    for (const box of range.getClientRects()) if (box.width > 1 && box.height > 1) boxes.push({ box, node, what: words(node.data) });
  }
  for (const element of document.querySelectorAll("img, canvas, select, input")) {
    const box = element.getBoundingClientRect();
    if (box.width > 1 && isSeen(element)) boxes.push({ box, node: element, what: element.tagName.toLowerCase() + " " + (element.alt || element.type || "") });
  }
  boxes.sort((a, b) => a.box.top - b.box.top);
  for (let i = 0; i < boxes.length && problems.length < 8; ++i)
    for (let j = i + 1; j < boxes.length && boxes[j].box.top < boxes[i].box.bottom; ++j) {
      const a = boxes[i], b = boxes[j];
      if (a.node === b.node || a.node.contains(b.node) || b.node.contains(a.node)) continue;
      const across = Math.min(a.box.right, b.box.right) - Math.max(a.box.left, b.box.left);
      const down = Math.min(a.box.bottom, b.box.bottom) - Math.max(a.box.top, b.box.top);
      // Lines of a text stand closer than their letters are high.
      if (across > 2 && down > 0.4 * Math.min(a.box.height, b.box.height)) problems.push("“" + a.what + "” and “" + b.what + "” lie upon each other");
    }
  // A caption may be broken at spaces, hyphens and where the page says so, never within a word.
  for (const caption of document.querySelectorAll("figcaption")) {
    const within = document.createTreeWalker(caption, NodeFilter.SHOW_TEXT), range = document.createRange();
    for (let node = within.nextNode(); node; node = within.nextNode())
      for (const word of node.data.matchAll(/[^\s-]+/g)) {
        range.setStart(node, word.index);
        range.setEnd(node, word.index + word[0].length);
        const lines = new Set([...range.getClientRects()].filter(box => box.width > 0).map(box => Math.round(box.top)));
        if (lines.size > 1) problems.push("the word “" + word[0] + "” of a caption is broken");
      }
  }
  for (const element of document.body.querySelectorAll("*")) {
    const style = getComputedStyle(element);
    if (style.overflowX !== "visible" && style.overflowX !== "auto" && element.scrollWidth > element.clientWidth + 1 && element.clientWidth > 0)
      problems.push("“" + words(element.textContent) + "” is cut");
    if (element.tagName === "TABLE" && element.classList.contains("data") && element.getBoundingClientRect().right > document.documentElement.clientWidth)
      problems.push("a table of " + Math.round(element.getBoundingClientRect().width) + " pixels reaches out of the window");
  }
  return problems.slice(0, 8);
})()
)js";

/// Finds texts with too little contrast to their background (WCAG 2: 4.5 to 1 for small text).
constexpr const char* kContrast = R"js(
(() => {
  const numbers = colour => (colour.match(/[\d.]+/g) || []).map(Number);
  const light = colour => numbers(colour).slice(0, 3).map(one => one / 255).map(one => one <= 0.04045 ? one / 12.92 : Math.pow((one + 0.055) / 1.055, 2.4))
    .reduce((sum, one, index) => sum + one * [0.2126, 0.7152, 0.0722][index], 0);
  const behind = element => {
    for (let place = element; place; place = place.parentElement) {
      const colour = getComputedStyle(place).backgroundColor, alpha = numbers(colour)[3];
      if (alpha === undefined || alpha === 1) return colour;
    }
    return matchMedia("(prefers-color-scheme: dark)").matches && /dark/.test(getComputedStyle(document.documentElement).colorScheme) ? "rgb(18, 18, 18)" : "rgb(255, 255, 255)";
  };
  const problems = new Set(), walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = walker.nextNode(); node && problems.size < 5; node = walker.nextNode()) {
    const parent = node.parentElement;
    if (!node.data.trim() || /^(SCRIPT|STYLE|OPTION|NOSCRIPT|SELECT|SPAN)$/.test(parent.tagName) && !parent.className || !parent.checkVisibility()) continue;
    const [low, high] = [light(getComputedStyle(parent).color), light(behind(parent))].sort((a, b) => a - b);
    const contrast = (high + 0.05) / (low + 0.05);
    if (contrast < 4.5) problems.add("“" + node.data.trim().slice(0, 40) + "” has a contrast of " + contrast.toFixed(1));
  }
  return [...problems];
})()
)js";

}  // namespace

bool PageFindings::hasProblem(const std::string& part) const {
  return std::any_of(problems.begin(), problems.end(),
                     [&](const std::string& problem) { return problem.find(part) != std::string::npos; });
}

std::string PageFindings::text() const {
  std::string lines;
  for (const std::string& problem : problems) lines += problem + "\n";
  return lines;
}

std::string externalLoad(const std::string& html) {
  static const std::regex loads(
      "(src|href|action|data)\\s*=\\s*[\"']?(https?:|//|file:)|url\\(\\s*[\"']?(https?:|//|file:)|@import",
      std::regex::icase);
  std::smatch match;
  return std::regex_search(html, match, loads) ? match.str() : std::string();
}

PageFindings checkPage(Browser& browser, const std::filesystem::path& page) {
  PageFindings findings;
  const auto checkWidth = [&](const int(&size)[2], const std::string& where) {
    browser.resize(size[0], size[1]);
    const std::string overflow = browser.evaluate(kOverflow).get<std::string>();
    if (!overflow.empty()) findings.problems.push_back("too wide for " + where + ": " + overflow);
    for (const auto& problem : browser.evaluate(kLayout))
      findings.problems.push_back("on " + where + ": " + problem.get<std::string>());
  };
  const auto checkContrast = [&](const char* scheme) {
    browser.emulate("screen", scheme);
    for (const auto& problem : browser.evaluate(kContrast))
      findings.problems.push_back(std::string("on a ") + scheme + " page: " + problem.get<std::string>());
  };
  browser.emulate("screen", "light");
  browser.open(page, kDesk[0], kDesk[1]);
  for (const int* size : {kTablet, kDesk}) {
    browser.resize(size[0], size[1]);
    const nlohmann::json first = browser.evaluate(kFirstScreen);
    const auto later = [&](double& end, const char* what) {
      end = std::max(end, first.at(what).is_null() ? std::numeric_limits<double>::infinity()
                                                   : first.at(what).get<double>());
    };
    later(findings.firstChartEnds, "chart");
    later(findings.firstImageEnds, "image");
    findings.height = first.at("height");
  }
  const nlohmann::json found = browser.evaluate(kProbe);
  findings.canvases = found.at("canvases");
  findings.charts = found.at("charts");
  findings.tables = found.at("tables");
  findings.rows = found.at("rows");
  findings.images = found.at("images");
  findings.links = found.at("links");
  for (const auto& control : found.at("controls"))
    findings.controls.push_back({control.at("name"), control.at("slider"), control.at("changed")});
  for (const auto& problem : found.at("problems")) findings.problems.push_back(problem);
  for (const auto& file : found.at("files")) {
    const std::string name = file.get<std::string>();
    if (!std::filesystem::exists(page.parent_path() / name))
      findings.problems.push_back("a link leads to a file that is not there: " + name);
  }
  checkWidth(kDesk, "a desk");
  checkContrast("light");
  checkContrast("dark");
  checkWidth(kTablet, "a tablet");
  checkWidth(kPhone, "a phone");
  browser.emulate("print", "dark");
  checkWidth(kPaper, "paper");
  browser.emulate("screen", "light");
  for (const std::string& error : browser.errors()) findings.problems.push_back("script: " + error);
  for (const std::string& request : browser.requests())
    if (request.rfind("file:", 0) != 0)
      findings.problems.push_back("it asks for something elsewhere: " + request);
  if (const std::string load = externalLoad(readFile(page, std::uint64_t{1} << 30)); !load.empty())
    findings.problems.push_back("it would load from elsewhere: " + load);
  return findings;
}

}  // namespace lumivox::test
