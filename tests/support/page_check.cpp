#include "support/page_check.h"

#include <algorithm>
#include <regex>

#include "lumivox/base/file.h"

namespace lumivox::test {
namespace {

constexpr int kDesk[] = {1280, 900};
constexpr int kPhone[] = {390, 844};  // CSS pixels of a common one

/// Runs in the page and gives back what it found.
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

/// The widest element beyond the window's width that does not scroll by itself, or nothing. Charts follow the
/// window some frames later.
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
  const auto checkWidth = [&](const int(&size)[2], const char* where) {
    browser.resize(size[0], size[1]);
    const std::string overflow = browser.evaluate(kOverflow).get<std::string>();
    if (!overflow.empty())
      findings.problems.push_back(std::string("too wide for ") + where + ": " + overflow);
  };
  browser.open(page, kDesk[0], kDesk[1]);
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
  checkWidth(kPhone, "a phone");
  for (const std::string& error : browser.errors()) findings.problems.push_back("script: " + error);
  for (const std::string& request : browser.requests())
    if (request.rfind("file:", 0) != 0)
      findings.problems.push_back("it asks for something elsewhere: " + request);
  if (const std::string load = externalLoad(readFile(page, std::uint64_t{1} << 30)); !load.empty())
    findings.problems.push_back("it would load from elsewhere: " + load);
  return findings;
}

}  // namespace lumivox::test
