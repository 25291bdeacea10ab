#include "page/page_assets.h"

namespace lumivox::page {

const char* const kPageStyle = R"css(
:root { --ink: #1d2430; --soft: #5b6676; --line: #dfe4ea; --wash: #f5f7f9; --accent: #0b5c8f; --bad: #b3261e; --good: #2b7a3d; }
* { box-sizing: border-box; }
body { margin: 0; color: var(--ink); background: #fff; line-height: 1.5;
       font-family: system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", "Liberation Sans", sans-serif; }
main, header { max-width: 1180px; margin: 0 auto; padding: 0 24px; }
header { padding-top: 32px; padding-bottom: 12px; }
h1 { font-size: 1.9rem; margin: 0 0 4px; }
h2 { font-size: 1.45rem; margin: 48px 0 8px; padding-top: 16px; border-top: 2px solid var(--ink); }
h3 { font-size: 1.12rem; margin: 32px 0 6px; }
h4 { font-size: 1rem; margin: 20px 0 4px; }
h5 { font-size: .92rem; margin: 14px 0 2px; }
p { margin: 6px 0 10px; max-width: 78ch; }
.soft, .caption { color: var(--soft); }
.caption { font-size: .9rem; }
nav { margin: 10px 0; display: flex; flex-wrap: wrap; gap: 0 14px; }
a { color: var(--accent); }
code, .mono { font-family: ui-monospace, "DejaVu Sans Mono", "Liberation Mono", monospace; font-size: .86em; }
.scroll { overflow-x: auto; margin: 8px 0 14px; border: 1px solid var(--line); border-radius: 6px; }
table { border-collapse: collapse; width: 100%; font-size: .88rem; font-variant-numeric: tabular-nums; }
th, td { padding: 5px 10px; text-align: left; white-space: nowrap; border-bottom: 1px solid var(--line); vertical-align: top; }
th { background: var(--wash); font-weight: 600; position: sticky; top: 0; }
tr:last-child td { border-bottom: 0; }
td.number, th.number { text-align: right; }
td.wide { white-space: normal; min-width: 22em; }
td.cell { min-width: 14em; white-space: normal; }
dl.cell { grid-template-columns: max-content max-content; gap: 0 10px; margin: 0; font-size: .84rem; }
tr.default td:first-child { font-weight: 600; }
tr.total td { border-top: 2px solid var(--line); font-weight: 600; }
select { max-width: 100%; }
.uncertainty { color: var(--soft); }
.bad { color: var(--bad); font-weight: 600; } .good { color: var(--good); }
.charts { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(460px, 100%), 1fr)); gap: 20px; }
figure { margin: 0; min-width: 0; } figcaption { font-size: .84rem; color: var(--soft); }
.chart { position: relative; height: 360px; border: 1px solid var(--line); border-radius: 6px; padding: 8px; }
.chart.tall { height: 560px; }
.strip { display: flex; flex-wrap: wrap; gap: 12px; margin: 8px 0 16px; }
.strip figure { width: 200px; }
.strip img, .truth { display: block; width: 200px; border: 1px solid var(--line); border-radius: 3px; image-rendering: pixelated;
                     background-size: 100% 100%; background-repeat: no-repeat; }
.wipe canvas { display: block; width: 100%; max-width: 640px; border: 1px solid var(--line); border-radius: 3px; image-rendering: pixelated; }
.wipe input { display: block; width: 100%; max-width: 640px; margin: 6px 0; }
.ramp { height: 10px; width: 200px; border-radius: 3px; }
details { margin: 6px 0; } summary { cursor: pointer; color: var(--accent); }
pre { background: var(--wash); padding: 8px 12px; border-radius: 6px; overflow-x: auto; font-size: .82rem; margin: 6px 0; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 2px 18px; margin: 8px 0; font-size: .92rem; }
dt { color: var(--soft); } dd { margin: 0; overflow-wrap: anywhere; }
@media print { .scroll { overflow: visible; } details { display: block; } }
)css";

// The data block holds the very records of the JSON file beside the page. A pipeline has one colour on the
// whole page, and beyond eight of them another shape.
const char* const kPageHelpers = R"js(
"use strict";
const lumivoxPage = (function () {
  const block = document.getElementById("data");
  const data = block ? JSON.parse(block.textContent) : {};
  const palette = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a5195", "#555555"];
  const shapes = ["circle", "triangle", "rect", "rectRot", "star", "crossRot"];
  const names = [...new Set((data.analysed || []).flatMap(scene => scene.points).concat(data.voxels || []).map(record => record.pipeline))];
  const style = name => {
    const index = names.indexOf(name);
    return { colour: palette[index % palette.length], shape: shapes[Math.floor(index / palette.length) % shapes.length] };
  };
  const shortName = file => file.replace(/^.*\//, "").replace(/\.pipeline$/, "");
  const parameters = point => Object.entries(point.parameters).map(([name, value]) => name + " " + value).join(", ") || "default";
  const digits = value => value === null || value === undefined ? "-" : Number(value).toPrecision(3);
  return { data, palette, style, shortName, parameters, digits };
})();
)js";

const char* const kPageScript = R"js(
"use strict";
(function () {
  const { data, palette, shortName, parameters, digits } = lumivoxPage;

  function passChart(canvas, of, unit, text) {
    const scene = data.analysed[canvas.dataset.scene];
    const points = scene.points.filter(point => !point.failure);
    const names = [...new Set(points.flatMap(point => point.passes.map(pass => pass.pass)))];
    const rows = names.map(name => points.map(point => {
      const pass = point.passes.find(one => one.pass === name);
      return pass ? of(pass) : 0;
    }));
    const datasets = names.map((name, index) => ({ label: name, data: rows[index], backgroundColor: palette[index % palette.length] }));
    if (unit === "ms")
      datasets.push({ label: "between passes", backgroundColor: "#c4cbd4",
                      data: points.map(point => point.framework_share * point.frame_ms.median) });
    new Chart(canvas, {
      type: "bar", data: { labels: points.map(point => [shortName(point.pipeline), parameters(point)]), datasets },
      options: {
        indexAxis: "y", animation: false, maintainAspectRatio: false,
        scales: { x: { stacked: true, title: { display: true, text } }, y: { stacked: true } },
        plugins: { legend: { position: "bottom", labels: { boxWidth: 14, font: { size: 11 } } },
                   tooltip: { callbacks: { label: item => item.dataset.label + ": " + digits(item.raw) + " " + unit } } } } });
  }

  for (const canvas of document.querySelectorAll("canvas")) {
    if (canvas.dataset.chart === "time") passChart(canvas, pass => pass.device_ms.median, "ms", "time per pass, ms");
    if (canvas.dataset.chart === "bytes") passChart(canvas, pass => pass.bytes / 1048576, "MiB", "memory taken per pass, MiB");
  }
})();
)js";

}  // namespace lumivox::page
