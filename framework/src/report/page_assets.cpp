#include "report/page_assets.h"

namespace lumivox::report {

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
p { margin: 6px 0 10px; max-width: 78ch; }
.soft, .caption { color: var(--soft); }
.caption { font-size: .9rem; }
nav { margin: 10px 0; } nav a { margin-right: 14px; white-space: nowrap; }
a { color: var(--accent); }
code, .mono { font-family: ui-monospace, "DejaVu Sans Mono", "Liberation Mono", monospace; font-size: .86em; }
.scroll { overflow-x: auto; margin: 8px 0 14px; border: 1px solid var(--line); border-radius: 6px; }
table { border-collapse: collapse; width: 100%; font-size: .88rem; font-variant-numeric: tabular-nums; }
th, td { padding: 5px 10px; text-align: left; white-space: nowrap; border-bottom: 1px solid var(--line); vertical-align: top; }
th { background: var(--wash); font-weight: 600; position: sticky; top: 0; }
tr:last-child td { border-bottom: 0; }
td.number, th.number { text-align: right; }
td.wide { white-space: normal; min-width: 22em; }
tr.default td:first-child { font-weight: 600; }
tr.total td { border-top: 2px solid var(--line); font-weight: 600; }
.uncertainty { color: var(--soft); }
.bad { color: var(--bad); font-weight: 600; } .good { color: var(--good); }
.charts { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(460px, 100%), 1fr)); gap: 20px; }
figure { margin: 0; } figcaption { font-size: .84rem; color: var(--soft); }
.chart { position: relative; height: 360px; border: 1px solid var(--line); border-radius: 6px; padding: 8px; }
.chart.tall { height: 560px; }
.strip { display: flex; flex-wrap: wrap; gap: 12px; margin: 8px 0 16px; }
.strip figure { width: 200px; }
.strip img, .truth { display: block; width: 200px; border: 1px solid var(--line); border-radius: 3px; image-rendering: pixelated;
                     background-size: 100% 100%; background-repeat: no-repeat; }
.ramp { height: 10px; width: 200px; border-radius: 3px; }
details { margin: 6px 0; } summary { cursor: pointer; color: var(--accent); }
pre { background: var(--wash); padding: 8px 12px; border-radius: 6px; overflow-x: auto; font-size: .82rem; margin: 6px 0; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 2px 18px; margin: 8px 0; font-size: .92rem; }
dt { color: var(--soft); } dd { margin: 0; overflow-wrap: anywhere; }
@media print { .scroll { overflow: visible; } details { display: block; } }
)css";

// The data block holds the very records of the JSON file beside the page.
const char* const kPageScript = R"js(
"use strict";
(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const palette = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a5195", "#555555"];
  const pipelineNames = [...new Set(data.scenes.flatMap(scene => scene.points.map(point => point.pipeline)))];
  const shade = name => palette[pipelineNames.indexOf(name) % palette.length];
  const shortName = file => file.replace(/^.*\//, "").replace(/\.pipeline$/, "");
  const parameters = point => Object.entries(point.parameters).map(([name, value]) => name + " " + value).join(", ") || "default";
  const digits = value => value === null ? "-" : Number(value).toPrecision(3);

  // Bars from the lower to the upper quartile of the time, and of one uncertainty of the error to both sides.
  const errorBars = {
    id: "errorBars",
    afterDatasetsDraw(chart) {
      const { ctx, scales: { x, y }, chartArea } = chart;
      ctx.save();
      ctx.beginPath();
      ctx.rect(chartArea.left, chartArea.top, chartArea.width, chartArea.height);
      ctx.clip();
      chart.data.datasets.forEach((dataset, index) => {
        if (!chart.isDatasetVisible(index)) return;
        ctx.strokeStyle = dataset.borderColor;
        ctx.lineWidth = 1.2;
        for (const point of dataset.data) {
          const px = x.getPixelForValue(point.x), py = y.getPixelForValue(point.y);
          const left = x.getPixelForValue(point.low), right = x.getPixelForValue(point.high);
          const top = y.getPixelForValue(point.y + point.uncertainty);
          const bottom = point.y > point.uncertainty ? y.getPixelForValue(point.y - point.uncertainty) : chartArea.bottom;
          ctx.beginPath();
          ctx.moveTo(left, py); ctx.lineTo(right, py);
          ctx.moveTo(left, py - 4); ctx.lineTo(left, py + 4);
          ctx.moveTo(right, py - 4); ctx.lineTo(right, py + 4);
          ctx.moveTo(px, top); ctx.lineTo(px, bottom);
          ctx.moveTo(px - 4, top); ctx.lineTo(px + 4, top);
          ctx.moveTo(px - 4, bottom); ctx.lineTo(px + 4, bottom);
          ctx.stroke();
        }
      });
      ctx.restore();
    }
  };

  // Levels that mean something: the error of leaving the component out.
  const levels = {
    id: "levels",
    afterDatasetsDraw(chart) {
      const { ctx, scales: { y }, chartArea } = chart;
      ctx.save();
      ctx.setLineDash([6, 4]);
      ctx.strokeStyle = ctx.fillStyle = "#5b6676";
      ctx.font = "11px sans-serif";
      (chart.options.levels || []).forEach((level, index) => {
        const at = y.getPixelForValue(level.value), left = index % 2 === 0;
        if (at < chartArea.top || at > chartArea.bottom) return;
        ctx.beginPath(); ctx.moveTo(chartArea.left, at); ctx.lineTo(chartArea.right, at); ctx.stroke();
        ctx.textAlign = left ? "left" : "right";  // two levels can lie upon each other
        ctx.fillText(level.text, left ? chartArea.left + 6 : chartArea.right - 6, at - 4);
      });
      ctx.restore();
    }
  };

  const metrics = {
    rmse: { title: "RMSE, W/(sr m²)", of: error => error.rmse },
    relative_mse: { title: "relative MSE", of: error => error.relative_mse },
    percentile_95: { title: "95th percentile of the error, W/(sr m²)", of: error => ({ value: error.percentile_95 }) },
    flip_hdr: { title: "mean FLIP", of: error => ({ value: error.flip_hdr }) }
  };

  function errorChart(canvas, metric) {
    const scene = data.scenes[canvas.dataset.scene], component = canvas.dataset.component;
    const series = new Map(), nothing = new Map();
    for (const point of scene.points) {
      if (point.failure || !(point.frame_ms.median > 0)) continue;
      for (const error of point.errors) {
        if (error.component !== component || (component === "final" && error.output !== "whole_picture")) continue;
        if (metric === "rmse" && error.rmse_of_nothing > 0) nothing.set(error.truth, error.rmse_of_nothing);
        const measured = metrics[metric].of(error);
        if (!(measured.value > 0)) continue;
        const key = point.pipeline + "|" + error.output + "|" + error.truth;
        if (!series.has(key)) series.set(key, { pipeline: point.pipeline, output: error.output, truth: error.truth, kind: error.kind, data: [] });
        series.get(key).data.push({
          x: point.frame_ms.median, y: measured.value, low: point.frame_ms.lower_quartile, high: point.frame_ms.upper_quartile,
          uncertainty: measured.uncertainty || 0, text: parameters(point) });
      }
    }
    const datasets = [...series.values()].map(one => ({
      label: shortName(one.pipeline) + " against " + one.truth,
      data: one.data.sort((a, b) => a.x - b.x),
      showLine: true, borderWidth: 1.5, pointRadius: 5, borderColor: shade(one.pipeline),
      backgroundColor: one.kind === "bias" ? shade(one.pipeline) : "#ffffff",
      borderDash: one.kind === "bias" ? [] : [5, 4] }));
    const times = datasets.flatMap(set => set.data.flatMap(point => [point.low, point.high])).filter(value => value > 0);
    const errors = datasets.flatMap(set => set.data.map(point => point.y)).concat([...nothing.values()]);
    new Chart(canvas, {
      type: "scatter", data: { datasets }, plugins: [errorBars, levels],
      options: {
        animation: false, maintainAspectRatio: false,
        levels: [...nothing].map(([truth, value]) => ({ value, text: "left out: " + truth })),
        scales: {
          x: { type: "logarithmic", title: { display: true, text: "frame time, ms" },
               min: Math.min(...times) / 1.3, max: Math.max(...times) * 1.3 },
          y: { type: "logarithmic", title: { display: true, text: metrics[metric].title },
               min: Math.min(...errors) / 1.5, max: Math.max(...errors) * 1.5 } },
        plugins: {
          legend: { position: "bottom", labels: { boxWidth: 14, font: { size: 11 } } },
          tooltip: { callbacks: { label: item => item.dataset.label + "; " + item.raw.text + ": " + digits(item.raw.x) + " ms, "
            + digits(item.raw.y) + " ± " + digits(item.raw.uncertainty) } } } } });
  }

  function passChart(canvas, of, unit, text) {
    const scene = data.scenes[canvas.dataset.scene];
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
    if (canvas.dataset.chart === "error") errorChart(canvas, "rmse");
    if (canvas.dataset.chart === "time") passChart(canvas, pass => pass.device_ms.median, "ms", "time per pass, ms");
    if (canvas.dataset.chart === "bytes") passChart(canvas, pass => pass.bytes / 1048576, "MiB", "memory taken per pass, MiB");
  }
  for (const choice of document.querySelectorAll("select.metric"))
    choice.addEventListener("change", () => {
      for (const canvas of document.querySelectorAll("canvas[data-chart=error][data-scene='" + choice.dataset.scene + "']")) {
        Chart.getChart(canvas).destroy();
        errorChart(canvas, choice.value);
      }
    });
})();
)js";

}  // namespace lumivox::report
