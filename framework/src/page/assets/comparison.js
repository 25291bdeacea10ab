"use strict";
// Error against time: the charts of all pipelines at all their points, and the tables of fronts, equal time and equal error.
const comparisonSection = (function () {
  const { data, h, caption, list, table, isNumber, milliseconds, number, measured, quartiles, plain, shortName, words, parametersText,
          componentTitle, style, chart } = lumivox;
  const metrics = { rmse: "RMSE", relative_mse: "relative MSE", percentile95: "95th percentile", flip: "FLIP" };
  const axes = { rmse: "RMSE, W/(sr m²)", relative_mse: "relative MSE", percentile95: "95th percentile of the error, W/(sr m²)", flip: "mean FLIP" };
  const against = { misses: "full transport: what a viewer misses", bias: "the technique's own model: its bias" };

  // ---- charts

  // Bars from the lower to the upper quartile of the time, and of one uncertainty of the error to both sides.
  const errorBars = {
    id: "errorBars",
    afterDatasetsDraw(drawn) {
      const { ctx, scales: { x, y }, chartArea } = drawn;
      ctx.save();
      ctx.beginPath();
      ctx.rect(chartArea.left, chartArea.top, chartArea.width, chartArea.height);
      ctx.clip();
      drawn.data.datasets.forEach((dataset, index) => {
        if (!dataset.bars || !drawn.isDatasetVisible(index)) return;
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
    afterDatasetsDraw(drawn) {
      const { ctx, scales: { y }, chartArea } = drawn;
      ctx.save();
      ctx.setLineDash([6, 4]);
      ctx.strokeStyle = ctx.fillStyle = "#5b6676";
      ctx.font = "11px sans-serif";
      for (const level of drawn.options.levels || []) {
        const at = y.getPixelForValue(level.value);
        if (at < chartArea.top || at > chartArea.bottom) continue;
        ctx.beginPath(); ctx.moveTo(chartArea.left, at); ctx.lineTo(chartArea.right, at); ctx.stroke();
        ctx.fillText(level.text, chartArea.left + 6, at - 4);
      }
      ctx.restore();
    }
  };

  function drawnPoint(comparison, index) {
    const point = comparison.points[index], time = point.frame_ms;
    const by = point.beaten_by === null ? null : comparison.points[point.beaten_by];
    return { x: time.median, y: point.error.value, low: time.lower_quartile, high: time.upper_quartile,
             uncertainty: point.error.uncertainty || 0, front: by === null,
             text: parametersText(point.parameters) + ": " + number(time.median) + " ms, " + plain(point.error)
               + (by === null ? "; on the Pareto front" : "; beaten by " + shortName(by.file) + " (" + parametersText(by.parameters) + ")") };
  }

  function configuration(scene, comparison) {
    const datasets = comparison.pipelines.map((pipeline, index) => {
      const own = comparison.points.map((point, at) => at).filter(at => comparison.points[at].pipeline === index
        && comparison.points[at].error.value > 0);
      const points = pipeline.front.concat(own.filter(at => !pipeline.front.includes(at))).map(at => drawnPoint(comparison, at));
      const { colour, shape } = style(pipeline.file);
      return { label: shortName(pipeline.file), data: points, bars: true, showLine: true, borderWidth: 1.5, pointRadius: 5,
               borderColor: colour, backgroundColor: colour, pointStyle: shape,
               pointBackgroundColor: points.map(point => point.front ? colour : "#ffffff"),
               segment: { borderColor: segment => segment.p1DataIndex < pipeline.front.length ? undefined : "transparent" } };
    });
    const all = datasets.flatMap(set => set.data);
    const times = all.flatMap(point => [point.low, point.high]).filter(value => value > 0);
    const levelOf = comparison.metric !== "rmse" ? [] : scene.points.flatMap(point => point.errors)
      .filter(error => error.component === comparison.component && error.reference === comparison.reference && error.rmse_of_nothing > 0)
      .slice(0, 1).map(error => ({ value: error.rmse_of_nothing, text: "left out" }));
    const errors = all.map(point => point.y).concat(levelOf.map(level => level.value));
    const range = { left: Math.min(...times) / 1.3, right: Math.max(...times) * 1.3 };
    const steps = comparison.front.map(at => ({ x: comparison.points[at].frame_ms.median, y: comparison.points[at].error.value }));
    datasets.push({ label: "least error within a time", data: steps.concat([{ x: range.right, y: steps[steps.length - 1].y }]),
                    showLine: true, stepped: "before", pointRadius: 0, pointHitRadius: 0, borderWidth: 5, borderColor: "#0000001c",
                    backgroundColor: "#0000001c", pointStyle: "line" });
    // The legend shows a pipeline's colour, whether its first point is hollow or not.
    const generateLabels = drawn => Chart.defaults.plugins.legend.labels.generateLabels(drawn)
      .map(label => ({ ...label, fillStyle: drawn.data.datasets[label.datasetIndex].backgroundColor }));
    return {
      type: "scatter", data: { datasets }, plugins: [errorBars, levels],
      options: {
        animation: false, maintainAspectRatio: false, levels: levelOf,
        scales: {
          x: { type: "logarithmic", title: { display: true, text: "frame time, ms" }, min: range.left, max: range.right,
               ticks: { maxRotation: 0, autoSkipPadding: 12 } },
          y: { type: "logarithmic", title: { display: true, text: axes[comparison.metric] },
               min: Math.min(...errors) / 1.5, max: Math.max(...errors) * 1.5 } },
        plugins: {
          legend: { position: "bottom", labels: { boxWidth: 14, font: { size: 11 }, usePointStyle: true, generateLabels } },
          tooltip: { filter: item => item.raw.text !== undefined,
                     callbacks: { label: item => item.dataset.label + ", " + item.raw.text } } } } };
  }

  // ---- tables

  /** The parameters in which the points of a pipeline differ: the others say nothing here. */
  function differingParameters(comparison, point) {
    const others = comparison.points.filter(other => other.pipeline === point.pipeline);
    return parametersText(Object.fromEntries(Object.entries(point.parameters)
      .filter(([name, value]) => others.some(other => other.parameters[name] !== value))));
  }
  const pointName = (comparison, point) =>
    [shortName(point.file), " ", h("span", { class: "soft" }, "(" + differingParameters(comparison, point) + ")")];

  /** From which budget on which pipeline has the least error. */
  function rangeTable(comparison) {
    return table([{ title: "Budget, ms", kind: "number" }, { title: "Least error", kind: "number" }, { title: "Pipeline" },
                  { title: "Parameters" }, { title: "Not told apart from it", kind: "wide" }],
      comparison.ranges.map(range => {
        const [best, ...others] = range.best.map(at => comparison.points[at]);
        return [range.to_ms === null ? "from " + milliseconds(range.from_ms) + " on" : milliseconds(range.from_ms) + " – " + milliseconds(range.to_ms),
                measured(best.error), h("b", null, shortName(best.file)), differingParameters(comparison, best),
                others.map(other => shortName(other.file)).join(", ")];
      }));
  }

  /** Pipelines without a point on the Pareto front, and whose points beat theirs. */
  function beatenList(comparison) {
    const beaten = comparison.pipelines.map((pipeline, index) => ({ pipeline, index })).filter(one => !one.pipeline.on_front);
    if (beaten.length === 0) return h("p", null, "Every pipeline is unbeaten at some budget.");
    return [h("p", null, "Beaten at every budget:"), list(beaten.map(({ pipeline, index }) => {
      const by = [...new Set(comparison.points.filter(point => point.pipeline === index && point.beaten_by !== null)
        .map(point => comparison.points[point.beaten_by].pipeline))].sort((a, b) => a - b);
      return shortName(pipeline.file) + ", by " + by.map(at => at === index ? "itself at other parameters"
        : shortName(comparison.pipelines[at].file)).join(", ");
    }))];
  }

  function reachedText(cell, value, notReached, text) {
    if (cell.reach === "not_measured") return "-";
    if (cell.reach === "not_reached") return h("span", { class: "soft" }, notReached);
    const shown = [cell.reach === "at_most" ? "≤ " : null, measured({ value: cell[value], uncertainty: cell.uncertainty }, text)];
    return cell.best ? h("b", null, shown) : shown;
  }

  function equalTable(comparison, cells, limit, value, title, notReached, text) {
    const limits = comparison.pipelines[0][cells].map(cell => cell[limit]);
    return table([{ title: "Pipeline" }, ...limits.map(one => ({ title: title(one), kind: "number" }))],
      comparison.pipelines.map(pipeline => [shortName(pipeline.file), ...pipeline[cells].map(cell => reachedText(cell, value, notReached, text))]));
  }

  function pointTable(comparison) {
    return table([{ title: "Pipeline" }, { title: "Parameters" }, { title: "Frame, ms", kind: "number" }, { title: "Error", kind: "number" },
                  { title: "Front" }],
      comparison.points.map(point => ({ kind: point.beaten_by === null ? "default" : "", cells: [
        shortName(point.file), differingParameters(comparison, point), quartiles(point.frame_ms), measured(point.error),
        point.beaten_by === null ? h("span", { class: "good" }, "on the Pareto front")
                                 : ["beaten by ", pointName(comparison, comparison.points[point.beaten_by])]] })));
  }

  function tables(comparison) {
    const four = value => lumivox.significant(value, 4);
    const equalTime = comparison.pipelines[0].equal_time.length > 0, equalError = comparison.pipelines[0].equal_error.length > 0;
    return [caption(metrics[comparison.metric] + " against the reference's layer ", h("code", null, comparison.reference), "."),
            h("h5", null, "Least error within a budget"), rangeTable(comparison), beatenList(comparison),
            equalTime && [h("h5", null, "Equal time: the error that each reaches"),
                          equalTable(comparison, "equal_time", "ms", "error", limit => four(limit) + " ms", "slower", number)],
            equalError ? [h("h5", null, "Equal error: the time that each needs, ms"),
                          equalTable(comparison, "equal_error", "error", "ms", four, "not reached", milliseconds)]
                       : h("p", null, "All errors are the same within 0.5 %: there is nothing to interpolate between."),
            h("h5", null, "All points, by time"), pointTable(comparison)];
  }

  // ---- the section

  /** What the claims of a scene's fronts rest on. */
  function basis(scene) {
    if (scene.comparisons.length === 0) return "";
    const one = scene.comparisons[0];
    let text = " Times count as different beyond " + (100 * one.least_time_share).toFixed(1) + " %" + (one.controls === 0
      ? ", since no point was timed twice here."
      : ": so far apart, at most, lay the times of " + one.controls + " points that were timed twice, and at least 5 %.");
    const undecided = scene.comparisons.reduce((most, other) => other.undecided > most.undecided ? other : most);
    if (undecided.undecided > 0)
      text += " Of " + undecided.undecided + " of " + undecided.points.length + " points there are fewer than " + data.least_repeats
        + " timed frames or seeds: whether they are better or worse is undecided, and they neither beat nor are beaten.";
    return text;
  }

  function chooser(label, kind, choices, changed) {
    const select = h("select", { "data-choose": kind }, Object.entries(choices).map(([value, title]) => h("option", { value }, title)));
    select.addEventListener("change", () => changed(select.value));
    return h("label", null, label + ": ", select, " ");
  }

  return function (scene) {
    const comparisons = scene.comparisons.filter(one => one.front.length > 0);
    const components = scene.components;
    const chosen = { metric: "rmse", against: "misses" };
    // A component with one reference has one comparison, whatever it is to be judged against.
    const shownOf = component => {
      const fitting = comparisons.filter(one => one.component === component && one.metric === chosen.metric);
      return fitting.find(one => one.against === chosen.against) || fitting[0];
    };
    const followers = [];
    const choose = kind => value => { chosen[kind] = value; followers.forEach(follow => follow()); };

    const figures = [], nothing = [];
    for (const component of components) {
      if (!shownOf(component)) {
        nothing.push(componentTitle(component));
        continue;
      }
      const drawn = chart(() => configuration(scene, shownOf(component)), { "data-chart": "error", "data-component": component });
      followers.push(drawn.redraw);
      figures.push(h("figure", null, h("h4", null, componentTitle(component)), drawn.frame));
    }
    // The whole image is what a reader looks for first.
    const details = [...components].reverse().filter(shownOf).map(component => {
      const place = h("div", null, tables(shownOf(component)));
      followers.push(() => place.replaceChildren(...[h("div", null, tables(shownOf(component)))]));
      return h("details", { open: component === "final" },
               h("summary", null, componentTitle(component) + ": fronts, equal time, equal error"), place);
    });
    return [
      h("h3", null, "Error against run time"),
      caption("All pipelines at all points of their sweeps. Bars: quartiles of the frame time; one standard uncertainty of the error, "
        + "of the reference's noise and the spread over seeds together. Filled points are on the Pareto front of all: no other point is as good in "
        + "both time and error and better in one by more than three standard uncertainties, so points within their uncertainties are "
        + "both on it. The grey steps bound all points by their values alone. Coloured lines join the points of one pipeline that none "
        + "of its own beats: the tables interpolate along them. The dashed grey line is the error of leaving the component out. Down and "
        + "to the left is better." + basis(scene)),
      scene.left_out_points.length > 0 && lumivox.folded(
        `For ${scene.left_out_points.length} points of the sweeps there was no time within the budget of ${data.budget_s} s`,
        list(scene.left_out_points.map(point => shortName(point.pipeline) + ": " + parametersText(point.parameters)))),
      h("p", null, comparisons.length > 0 && chooser("Measure", "metric", metrics, choose("metric")),
        comparisons.some(one => one.against === "bias") && chooser("Against", "against", against, choose("against")),
        h("span", { class: "caption" }, "A few very bright pixels, such as the edges of an area light, can rule the RMSE; the 95th percentile "
          + "and FLIP are less moved by them.")),
      h("div", { class: "charts" }, figures),
      nothing.length > 0 && caption("Nothing to draw: " + nothing.join(", ")
        + " has no error, since neither the reference nor any image has such light."),
      caption("In the tables below: the logarithm of the error is linear in that of the time between two measured points of one "
        + "pipeline; nothing is extrapolated. ≤: the slowest (fastest) point measured has that much within the budget (the error) "
        + "already. ±: one standard uncertainty, from those of both points through the interpolation. Bold: the least, and what cannot "
        + "be told apart from it."),
      details];
  };
})();
