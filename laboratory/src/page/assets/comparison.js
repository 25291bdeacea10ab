"use strict";
// Pipelines against each other in one scene: what is compared is chosen once, and the plot of error against time, the table of the
// default points and the tables of fronts, equal time and equal error follow.
const comparisonOf = (function () {
  const { data, h, caption, list, longList, folded, plural, counted, table, chooser, sortedBy, isNumber, milliseconds, number, measured, quartiles, hasQuartiles,
          plain, soft, shortName, pipelineName, words, parametersText, componentTitle, percent, bytes, listed, style, theme, swatch,
          chart } = lumivox;
  const metrics = { flip: "FLIP", rmse: "RMSE", relative_mse: "relative MSE", percentile95: "95th percentile" };
  const units = { flip: "", rmse: "W/(sr m²)", relative_mse: "", percentile95: "W/(sr m²)" };
  const against = { bias: "its own bounces", misses: "full transport" };

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
          if (point.low < point.high) {
            ctx.moveTo(left, py); ctx.lineTo(right, py);
            ctx.moveTo(left, py - 4); ctx.lineTo(left, py + 4);
            ctx.moveTo(right, py - 4); ctx.lineTo(right, py + 4);
          }
          ctx.moveTo(px, top); ctx.lineTo(px, bottom);
          ctx.moveTo(px - 4, top); ctx.lineTo(px + 4, top);
          ctx.moveTo(px - 4, bottom); ctx.lineTo(px + 4, bottom);
          ctx.stroke();
        }
      });
      ctx.restore();
    }
  };

  // Names of the points on the front, as far as they stand clear of points and of each other.
  const pointNames = {
    id: "pointNames",
    afterDatasetsDraw(drawn) {
      const { ctx, scales: { x, y }, chartArea } = drawn, size = 11, points = [];
      drawn.data.datasets.forEach((dataset, index) => {
        if (dataset.pointRadius === 0 || !drawn.isDatasetVisible(index)) return;
        for (const point of dataset.data) points.push({ x: x.getPixelForValue(point.x), y: y.getPixelForValue(point.y), name: point.name });
      });
      ctx.save();
      ctx.font = size + "px Helvetica, Arial, sans-serif";
      ctx.fillStyle = theme().ink;
      ctx.textAlign = "left";
      ctx.textBaseline = "alphabetic";
      const measured = { wideOf: name => ctx.measureText(name).width, onlyClear: true };
      for (const one of plots.placeNames(points, chartArea, size, measured)) ctx.fillText(one.name, one.x, one.y);
      ctx.restore();
    }
  };

  function drawnPoint(comparison, index) {
    const point = comparison.points[index], time = point.frame_ms;
    const by = point.beaten_by === null ? null : comparison.points[point.beaten_by];
    const differing = differingParameters(comparison, point);
    return { x: time.median, y: point.error.value,
             name: by === null ? shortName(point.file) + (differing === "default" ? "" : ", " + differing) : null, low: hasQuartiles(time) ? time.lower_quartile : time.median,
             high: hasQuartiles(time) ? time.upper_quartile : time.median,
             uncertainty: point.error.uncertainty || 0, front: by === null,
             text: parametersText(point.parameters) + ": " + milliseconds(time.median) + " ms, " + plain(point.error)
               + (by === null ? "; on the Pareto front" : "; beaten by " + shortName(by.file) + " (" + parametersText(by.parameters) + ")") };
  }

  // A tenth of the span on both sides. What spans little is shown as it is, else ticks would be missing.
  const fitted = values => {
    const low = Math.min(...values), high = Math.max(...values);
    if (high < 3 * low) {
      const space = Math.max(0.1 * (high - low), 0.01 * high);
      return { type: "linear", min: Math.max(0, low - space), max: high + space };
    }
    const space = Math.pow(high / low, 0.1);
    return { type: "logarithmic", min: low / space, max: high * space };
  };

  function configuration(comparison) {
    const { paper, band } = theme();
    const datasets = comparison.pipelines.map((pipeline, index) => {
      const own = comparison.points.map((point, at) => at).filter(at => comparison.points[at].pipeline === index
        && comparison.points[at].error.value > 0);
      const points = pipeline.front.concat(own.filter(at => !pipeline.front.includes(at))).map(at => drawnPoint(comparison, at));
      const { colour, shape } = style(pipeline.file);
      return { label: shortName(pipeline.file), data: points, bars: true, showLine: true, borderWidth: 1.5, pointRadius: 5, pointHoverRadius: 8,
               borderColor: colour, backgroundColor: colour, pointStyle: shape,
               pointBackgroundColor: points.map(point => point.front ? colour : paper),
               segment: { borderColor: segment => segment.p1DataIndex < pipeline.front.length ? undefined : "transparent" } };
    });
    const all = datasets.flatMap(set => set.data);
    const times = all.flatMap(point => [point.low, point.high]).filter(value => value > 0);
    const errors = all.flatMap(point => [point.y, point.y + point.uncertainty, point.y - point.uncertainty]).filter(value => value > 0);
    const x = fitted(times), y = fitted(errors);
    const steps = comparison.front.map(at => ({ x: comparison.points[at].frame_ms.median, y: comparison.points[at].error.value }));
    datasets.push({ label: "least error within a time", data: steps.concat([{ x: x.max, y: steps[steps.length - 1].y }]),
                    showLine: true, stepped: "before", pointRadius: 0, pointHitRadius: 0, borderWidth: 5, borderColor: band,
                    backgroundColor: band, pointStyle: "line" });
    return {
      type: "scatter", data: { datasets }, plugins: [errorBars, pointNames],
      options: {
        animation: false, maintainAspectRatio: false,
        scales: {
          x: { title: { display: true, text: "frame time, ms" }, ...x, ticks: { maxRotation: 0, autoSkipPadding: 16, callback: tickOf(x) } },
          y: { title: { display: true, text: errorTitle(comparison) }, ...y,
               ticks: { autoSkipPadding: 10, callback: tickOf(y) } } },
        plugins: {
          legend: { display: false },
          tooltip: { filter: item => item.raw.text !== undefined,
                     callbacks: { label: item => item.dataset.label + ", " + item.raw.text } } } } };
  }
  const errorTitle = ({ metric }) => metrics[metric] + (units[metric] && ", " + units[metric]);
  // Of an axis that begins and ends anywhere the ends have no numbers of their own.
  const tickOf = axis => value => {
    const nice = axis.type === "linear" ? value !== axis.min && value !== axis.max : [1, 2, 5].includes(Number(value.toExponential().split("e")[0]));
    return nice ? number(value) : null;
  };

  // ---- error against how well the voxels hold the surface

  const shares = { recall: "recall", precision: "precision", axis_share: "holes, rays along the axes", oblique_share: "holes, oblique rays" };
  const judgedVoxels = (scene, point) => {
    const { voxels } = scene.points[point.source];
    return voxels && isNumber(voxels.recall) ? voxels : null;
  };

  function shareConfiguration(scene, comparison, share) {
    const datasets = comparison.pipelines.map((pipeline, index) => {
      const data = comparison.points.filter(point => point.pipeline === index && point.error.value > 0 && judgedVoxels(scene, point)).map(point => {
        const x = judgedVoxels(scene, point)[share];
        return { x, y: point.error.value, low: x, high: x, uncertainty: point.error.uncertainty || 0,
                 text: parametersText(point.parameters) + ": " + shares[share] + " " + number(x) + ", " + plain(point.error) };
      }).sort((a, b) => a.x - b.x);
      const { colour, shape } = style(pipeline.file);
      return { label: shortName(pipeline.file), data, bars: true, showLine: false, pointRadius: 5, pointHoverRadius: 8,
               borderColor: colour, backgroundColor: colour, pointStyle: shape };
    }).filter(set => set.data.length > 0);
    const all = datasets.flatMap(set => set.data), low = Math.min(...all.map(point => point.x)), high = Math.max(...all.map(point => point.x));
    const space = Math.max(0.1 * (high - low), 0.01);
    const y = fitted(all.flatMap(point => [point.y, point.y + point.uncertainty, point.y - point.uncertainty]).filter(value => value > 0));
    return {
      type: "scatter", data: { datasets }, plugins: [errorBars],
      options: {
        animation: false, maintainAspectRatio: false,
        scales: {
          x: { type: "linear", min: Math.max(0, low - space), max: high + space, title: { display: true, text: shares[share] },
               ticks: { maxRotation: 0, autoSkipPadding: 16, callback: tickOf({ type: "linear", min: low - space, max: high + space }) } },
          y: { title: { display: true, text: errorTitle(comparison) }, ...y, ticks: { autoSkipPadding: 10, callback: tickOf(y) } } },
        plugins: { legend: { display: false }, tooltip: { callbacks: { label: item => item.dataset.label + ", " + item.raw.text } } } } };
  }

  /** Error against recall beside error against time; null: no point has voxels that were judged. */
  function voxelsSection(scene, comparisons, chosen, follow, following) {
    const drawable = comparison => comparison.points.some(point => point.error.value > 0 && judgedVoxels(scene, point));
    const all = comparisons.filter(drawable);
    // What is the same at all points has no plot, only its column in the table.
    const judged = scene.points.filter(point => point.voxels && isNumber(point.voxels.recall));
    const differs = name => new Set(judged.map(point => point.voxels[name])).size > 1;
    const names = Object.keys(shares), differing = names.filter(differs), same = names.filter(name => !differs(name));
    const notJudged = scene.points.filter(point => point.voxels && point.voxels.why_not);
    const missing = notJudged.length > 0 && longList("Not judged", notJudged.map(point =>
      shortName(point.pipeline) + ", " + parametersText(point.parameters) + ": " + point.voxels.output + ", " + point.voxels.why_not), "point");
    if (all.length === 0) return missing ? [missing] : null;
    let share = differing[0], last = all[0];
    const shown = () => last = drawable(chosen()) ? chosen() : last;
    const plots = () => {
      const byShare = chart(() => shareConfiguration(scene, shown(), share), { "data-chart": "recall" }, "Error against the recall of the voxels");
      const byTime = chart(() => configuration(shown()), { "data-chart": "time" }, "Error against frame time of the same comparison");
      follow(byShare.redraw);
      follow(byTime.redraw);
      const choices = Object.fromEntries(differing.map(name => [name, shares[name]]));
      return [h("p", { class: "choices" }, chooser("Over", "share", choices, share, value => { share = value; byShare.redraw(); })),
              following(() => caption(h("b", null, titleOf(shown())), ", ", metrics[shown().metric], ".")),
              h("div", { class: "charts" }, h("figure", null, byShare.frame), h("figure", null, byTime.frame))];
    };
    return [
      caption("The voxels that indirect light is gathered from, against the exact test of triangles and boxes. Of lists of fragments it is the "
        + "one nearest to the output; without a list the nearest grid that says which voxels are occupied. Recall: share of the touched voxels "
        + "that are occupied. Precision: share of the occupied voxels that are touched. Holes: share of the crossings of straight rays with the "
        + "surface at which the ray meets no occupied voxel within a voxel and a half. First seed."),
      same.length > 0 && h("p", null, "Not drawn, since all points have the same: " + same.map(name => shares[name] + " "
        + number(judged[0].voxels[name])).join("; ") + "."),
      differing.length > 0 && plots(),
      following(() => table(
        columns("Pipeline", "Parameters", "Voxels", ...["Grid", "Occupied", "Recall", "Precision", "Holes, axis rays", "Holes, oblique rays", "Error"]
          .map(title => [title, "number"])),
        shown().points.filter(point => judgedVoxels(scene, point)).map(point => {
          const voxels = judgedVoxels(scene, point), source = scene.points[point.source];
          return { pipeline: point.file, isDefault: source.default, kind: source.default ? "default" : "", cells: [
            named(point.file), differingParameters(shown(), point), lumivox.broken(voxels.output), voxels.resolution.join(" × "), voxels.occupied,
            voxels.recall.toFixed(4), voxels.precision.toFixed(4), percent(voxels.axis_share), percent(voxels.oblique_share),
            sortedBy(point.error.value, measured(point.error))] };
        }))),
      missing];
  }

  // ---- tables

  /** The parameters in which the points of a pipeline differ: the others say nothing here. */
  function differingParameters(comparison, point) {
    const others = comparison.points.filter(other => other.pipeline === point.pipeline);
    return parametersText(Object.fromEntries(Object.entries(point.parameters)
      .filter(([name, value]) => others.some(other => other.parameters[name] !== value))));
  }
  const columns = (...titles) => titles.map(title => typeof title === "string" ? { title } : { title: title[0], kind: title[1] });
  const named = file => [swatch(file), pipelineName(file)];

  /** From which frame time on which pipeline has the least error. */
  function rangeTable(comparison) {
    return table(columns("Frame time, ms", ["Least error", "number"], "Pipeline", "Parameters", ["Not told apart from it", "wide"]),
      comparison.ranges.map(range => {
        const [best, ...others] = range.best.map(at => comparison.points[at]);
        return [sortedBy(range.from_ms, range.to_ms === null ? "from " + milliseconds(range.from_ms) + " on"
                                                             : milliseconds(range.from_ms) + " – " + milliseconds(range.to_ms)),
                sortedBy(best.error.value, measured(best.error)), named(best.file), differingParameters(comparison, best),
                others.map((other, index) => [index > 0 && ", ", pipelineName(other.file)])];
      }));
  }

  /** Pipelines without a point on the Pareto front, and whose points beat theirs. */
  function beatenList(comparison) {
    const beaten = comparison.pipelines.map((pipeline, index) => ({ pipeline, index })).filter(one => !one.pipeline.on_front);
    if (beaten.length === 0) return h("p", null, "Every pipeline is unbeaten at some frame time.");
    return longList("Beaten at every frame time", beaten.map(({ pipeline, index }) => {
      const by = [...new Set(comparison.points.filter(point => point.pipeline === index && point.beaten_by !== null)
        .map(point => comparison.points[point.beaten_by].pipeline))].sort((a, b) => a - b);
      return shortName(pipeline.file) + ", by " + by.map(at => at === index ? "itself at other parameters"
        : shortName(comparison.pipelines[at].file)).join(", ");
    }), "pipeline");
  }

  function reachedCell(cell, value, notReached, text) {
    if (cell.reach === "not_measured") return sortedBy(null, "-");
    if (cell.reach === "not_reached") return sortedBy(null, soft(notReached));
    const shown = [cell.reach === "at_most" ? "≤ " : null, measured({ value: cell[value], uncertainty: cell.uncertainty }, text)];
    return sortedBy(cell[value], cell.best ? h("b", null, shown) : shown);
  }

  function equalTable(comparison, cells, limit, value, title, notReached, text) {
    const limits = comparison.pipelines[0][cells].map(cell => cell[limit]);
    return table(columns("Pipeline", ...limits.map(one => [title(one), "number"])),
      comparison.pipelines.map(pipeline => [named(pipeline.file), ...pipeline[cells].map(cell => reachedCell(cell, value, notReached, text))]));
  }

  function pointTable(scene, comparison) {
    return table(columns("Pipeline", "Parameters", ["Frame, ms", "number"], ["Error", "number"], ["Front", "wide"]),
      comparison.points.map(point => {
        const by = point.beaten_by === null ? null : comparison.points[point.beaten_by];
        return { pipeline: point.file, isDefault: scene.points[point.source].default, kind: scene.points[point.source].default ? "default" : "",
                 cells: [named(point.file), differingParameters(comparison, point), sortedBy(point.frame_ms.median, quartiles(point.frame_ms)),
                         sortedBy(point.error.value, measured(point.error)),
                         by === null ? h("span", { class: "good" }, "on the Pareto front")
                                     : ["beaten by ", pipelineName(by.file), " ", soft("(" + differingParameters(comparison, by) + ")")]] };
      }));
  }

  function tables(scene, comparison) {
    const four = value => lumivox.significant(value, 4);
    const equalTime = comparison.pipelines[0].equal_time.length > 0, equalError = comparison.pipelines[0].equal_error.length > 0;
    return [caption("Chosen above: ", h("b", null, titleOf(comparison)), ", ", metrics[comparison.metric], ", the reference's layer ",
                    h("code", null, comparison.reference), "."),
            h("h4", null, "Least error within a frame time"), rangeTable(comparison), beatenList(comparison),
            equalTime && [h("h4", null, "Equal time: the error that each reaches"),
                          equalTable(comparison, "equal_time", "ms", "error", limit => four(limit) + " ms", "slower")],
            h("h4", null, "Equal error: the time that each needs, ms"),
            equalError ? equalTable(comparison, "equal_error", "error", "ms", four, "not reached", milliseconds)
                       : h("p", null, "All errors are the same within 0.5 %: there is nothing to interpolate between."),
            h("h4", null, "All points, by time"), pointTable(scene, comparison)];
  }

  /** The error of a component at a point: against the reference that is wanted, or the only one. */
  function errorOf(point, component, against) {
    const own = point.errors.filter(error => error.component === component && (component !== "final" || error.output === "whole_image"));
    return own.find(error => error.against === against) || own[0];
  }
  function errorNumber(error, metric) {
    return error ? error.metrics[metric] : { value: null, uncertainty: null };
  }
  const isWhole = comparison => comparison.component === "final" && comparison.against === "misses";

  /** One row for each pipeline, at its default parameters; those that come to the same passes share one. */
  function defaultsTable(scene, comparison) {
    const { metric } = comparison, sameAs = file => Object.entries(scene.same_passes).filter(([, as]) => as === file).map(([one]) => one);
    const points = scene.points.filter(point => point.default && !(point.pipeline in scene.same_passes));
    const standing = point => {
      const own = comparison.points.filter(one => one.file === point.pipeline);
      if (point.failure) return h("span", { class: "bad" }, "failed");
      if (own.length === 0) return soft("has none of it");
      if (own.some(one => one.beaten_by === null)) return h("span", { class: "good" }, "on it");
      const others = own.map(one => comparison.points[one.beaten_by].file).filter(file => file !== point.pipeline);
      const by = [...new Set(others.map(shortName))];
      return h("span", { title: "by " + listed(by) }, "beaten");
    };
    const rows = points.map(point => {
      const error = errorNumber(errorOf(point, comparison.component, comparison.against), metric);
      const whole = errorNumber(errorOf(point, "final", "misses"), metric);
      const pruning = scene.pruning.find(one => one.pipeline === point.pipeline), saves = pruning && pruning.first_frame_saves;
      const same = sameAs(point.pipeline);
      return { value: error.value, cells: [
        [named(point.pipeline), same.length > 0 && [" ", soft("and " + listed(same.map(shortName)) + ": the same passes here")]],
        sortedBy(point.failure ? null : point.frame_ms.median, point.failure ? "-" : milliseconds(point.frame_ms.median)),
        sortedBy(error.value, measured(error)), ...(isWhole(comparison) ? [] : [sortedBy(whole.value, measured(whole))]),
        sortedBy(point.failure ? null : point.peak_bytes, point.failure ? "-" : bytes(point.peak_bytes)),
        sortedBy(saves && saves.told === "saved" ? saves.ms / saves.of_ms : null,
                 !saves ? "-" : saves.told === "saved" ? percent(saves.ms / saves.of_ms) : words(saves.told)), standing(point)] };
    });
    const last = value => isNumber(value) ? value : Infinity;
    rows.sort((a, b) => last(a.value) === last(b.value) ? 0 : last(a.value) - last(b.value));
    return table(columns("Pipeline", ["Frame, ms", "number"], [metrics[metric] + ", " + lightOf(comparison), "number"],
                         ...(isWhole(comparison) ? [] : [[metrics[metric] + ", whole image", "number"]]),
                         ["Memory", "number"], ["Leaving out saves", "number"], "Front"), rows);
  }

  // ---- what is shown first

  const lightOf = comparison => componentTitle(comparison.component).toLowerCase();
  const titleOf = comparison => lightOf(comparison) + " against " + against[comparison.against];

  /** What the claims of a scene's fronts rest on. */
  function basis(scene) {
    if (scene.comparisons.length === 0) return "";
    const one = scene.comparisons[0];
    let text = " Times count as different beyond " + (100 * one.least_time_share).toFixed(1) + " %" + (one.controls === 0
      ? ", since no point was timed twice here."
      : one.controls === 1 ? ": so far apart lay the two times of a point that was timed twice, and at least 5 %."
      : ": so far apart, at most, lay the times of " + one.controls + " points that were timed twice, and at least 5 %.");
    const undecided = scene.comparisons.reduce((most, other) => other.undecided > most.undecided ? other : most);
    if (undecided.undecided > 0)
      text += " " + undecided.undecided + " of " + plural(undecided.points.length, "point") + (undecided.undecided === 1 ? " has" : " have")
        + " fewer than " + data.least_repeats + " timed frames or seeds: whether better or worse is undecided, and no such point beats another "
        + "or is beaten.";
    return text;
  }

  /** A sentence on the components that all pipelines make alike; null: there are none. */
  function equalSentence(scene) {
    const equal = scene.comparisons.filter(one => one.equal_for_all && one.metric === "flip" && one.component !== "final");
    const components = [...new Set(equal.map(one => one.component))];
    if (components.length === 0) return null;
    return components.map(component => {
      const one = equal.find(other => other.component === component);
      const error = one.points.find(point => scene.points[point.source].default).error;
      return componentTitle(component) + " light is the same in all pipelines (FLIP " + plain(error) + "): it tells nothing apart. ";
    }).join("");
  }

  /** The points for which there was no time; null: none. */
  const leftOut = scene => scene.left_out_points.length === 0 ? null : !data.complete
    ? h("p", null, plural(scene.left_out_points.length, "point") + (scene.left_out_points.length === 1 ? " is" : " are") + " still to come.")
    : [h("p", null, `For ${plural(scene.left_out_points.length, "point")} there was no time within ${data.budget_s} s. The same command goes on: `,
         h("code", null, data.command)),
       folded(counted("Which ones", scene.left_out_points.length, "point"), list(scene.left_out_points.map(point =>
         shortName(point.pipeline) + ": " + parametersText(point.parameters))))];

  /** Of a scene: { plot, defaults, follow, chosen, sections, voxels }, the last made when it is asked for; null plot: there is nothing to compare. `follow` is told whenever
   *  something else is chosen. */
  return function (scene) {
    const comparisons = scene.comparisons.filter(one => one.front.length > 0);
    const led = scene.led_comparison === null ? null : scene.comparisons[scene.led_comparison];
    const followers = [];
    const nothing = scene.components.filter(component => !comparisons.some(one => one.component === component));
    if (!led || led.front.length === 0)
      return { plot: h("p", null, "No pipeline has an error to compare by."), defaults: null, equal: null, sections: leftOut(scene), voxels: () => null,
               chosen: () => null, follow: () => {} };
    const keyOf = one => one.component + "/" + one.against;
    let key = keyOf(led), metric = led.metric;
    const chosen = () => comparisons.find(one => keyOf(one) === key && one.metric === metric) || led;
    const changed = () => followers.forEach(follow => follow());
    const follow = work => followers.push(work);
    // The techniques' own model first, but of the whole image.
    const order = one => scene.components.indexOf(one.component) * 2 + ((one.against === "bias") === (one.component === "final") ? 1 : 0);
    const kinds = Object.fromEntries(comparisons.filter(one => one.metric === metric).sort((a, b) => order(a) - order(b))
      .map(one => [keyOf(one), componentTitle(one.component) + " against " + against[one.against]]));
    const choices = h("p", { class: "choices" },
      chooser("Light", "light", kinds, key, value => { key = value; changed(); }),
      chooser("Measure", "metric", metrics, metric, value => { metric = value; changed(); }));
    const drawn = chart(() => configuration(chosen()), { "data-chart": "error" }, "Error against frame time of all pipelines at all their points");
    follow(drawn.redraw);
    const following = make => {
      const place = h("div", null, make());
      follow(() => place.replaceChildren(h("div", null, make())));
      return place;
    };
    const legend = following(() => h("ul", { class: "legend" }, chosen().pipelines.map(one => h("li", null, swatch(one.file), shortName(one.file)))));
    return {
      plot: h("figure", { class: "plot" }, choices, drawn.frame, legend,
        h("figcaption", null, "Down and to the left is better. Filled: on the Pareto front. Grey: least error within a time. Bars: quartiles of "
          + "the time, uncertainty of the error.")),
      defaults: following(() => [defaultsTable(scene, chosen()), chosen().metric === "flip" && caption(data.units.flip)]), chosen, follow, equal: equalSentence(scene),
      sections: [
        caption("All pipelines at all points of their sweeps. Bars: quartiles of the frame time; one standard uncertainty of the error, "
          + "of the reference's noise and the spread over seeds together. Filled points are on the Pareto front of all: no other point is as good in "
          + "both time and error and better in one by more than three standard uncertainties, so points within their uncertainties are "
          + "both on it. The grey steps bound all points by their values alone. Coloured lines join the points of one pipeline that none "
          + "of its own beats: the tables interpolate along them." + basis(scene)),
        Object.keys(scene.same_passes).length > 0 && list(Object.entries(scene.same_passes).map(([file, as]) =>
          shortName(file) + " comes to the same passes as " + shortName(as) + " in this scene, and is not compared apart.")),
        leftOut(scene),
        nothing.length > 0 && caption("Nothing to compare: " + nothing.map(componentTitle).join(", ")
          + " has no error, since neither the reference nor any image has such light."),
        caption("In the tables below the logarithm of the error is linear in that of the time between two measured points of one "
          + "pipeline; nothing is extrapolated. ≤: the slowest (fastest) point measured has that much within the frame time (the error) "
          + "already. ±: one standard uncertainty, from those of both points through the interpolation. Bold: the least, and what cannot "
          + "be told apart from it."),
        following(() => tables(scene, chosen()))],
      voxels: () => voxelsSection(scene, comparisons, chosen, follow, following) };
  };
})();
