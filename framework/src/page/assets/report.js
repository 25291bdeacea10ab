"use strict";
// The page of a report: its sections from beginning to end.
(function () {
  const { data, h, caption, list, folded, table, number, milliseconds, percent, bytes, exposureText, thousands, measured, quartiles, shortName,
          words, parametersText, outputName, palette, chart, show } = lumivox;
  const sceneTitle = scene => scene.name || scene.file;
  const timesOf = time => time && time.repeats > 0;
  const good = text => h("span", { class: "good" }, text);
  const bad = text => h("span", { class: "bad" }, text);
  const rowKind = point => point.default ? "default" : "";
  const columns = (...titles) => titles.map(title => typeof title === "string" ? { title } : { title: title[0], kind: title[1] });

  /** The error of a component at a point: against the reference that is wanted, or the only one. */
  function errorOf(point, component, kind) {
    const own = point.errors.filter(error => error.component === component && (component !== "final" || error.output === "whole_image"));
    return own.find(error => error.kind === kind) || own[0];
  }

  // ---- all scenes together

  function summary() {
    const rows = data.scenes.flatMap(scene => {
      const comparison = scene.comparisons.find(one => one.component === "final" && one.against === "misses" && one.metric === "rmse")
        || scene.comparisons.find(one => one.component === "final" && one.metric === "rmse");
      const front = new Set(comparison ? comparison.points.filter(point => point.beaten_by === null).map(point => point.source) : []);
      return scene.points.map((point, index) => {
        const error = errorOf(point, "final", "miss");
        const pruning = point.default && scene.pruning.find(one => one.pipeline === point.pipeline);
        return { kind: rowKind(point), cells: [
          sceneTitle(scene), shortName(point.pipeline), parametersText(point.parameters), quartiles(point.frame_ms),
          error ? measured(error.rmse) : "-", error ? number(error.flip_hdr) : "-", error ? measured(error.mean_ratio) : "-",
          pruning ? percent(pruning.saved_share) + "; " + percent(pruning.saved_share_next) : "-",
          front.has(index) ? "on the Pareto front" : "",
          point.failure ? bad("failed") : point.health_findings.length === 0 ? good("good")
            : bad(point.health_findings.length + " finding" + (point.health_findings.length === 1 ? "" : "s"))] };
      });
    });
    return [
      h("h2", { id: "summary" }, "Summary"),
      caption("RMSE, FLIP and mean ratio of the whole image against full transport. “Saved”: share of the time of a first frame, and of "
        + "one that follows another, that leaving out unneeded work saves. Bold rows are the default parameters."),
      table(columns("Scene", "Pipeline", ["Parameters", "wide"], ["Frame, ms", "number"], ["RMSE, whole image", "number"],
                    ["FLIP", "number"], ["Mean ratio", "number"], ["Saved", "number"], "Front", "Health"), rows)];
  }

  function savedText(saved) {
    if (saved.told === "undecided") return "undecided with fewer than " + data.least_repeats + " repeats, of " + milliseconds(saved.of_ms) + " ms";
    if (saved.told === "not_measurable") return "not measurable, of " + milliseconds(saved.of_ms) + " ms";
    return milliseconds(saved.ms) + " of " + milliseconds(saved.of_ms) + " ms";
  }
  const sameImage = record => record.same_image ? good("yes") : bad("NO");

  function neededCell(scene, pipeline) {
    const record = scene.pruning.find(one => one.pipeline === pipeline);
    if (record) {
      const lines = { passes: record.passes_kept + " of " + record.passes_total,
                      variants: record.variants.needed + " / " + record.variants.compiled + " / " + record.variants.possible,
                      "memory left out": bytes(Math.max(0, record.bytes_keep_everything - record.bytes)) + " of " + bytes(record.bytes_keep_everything),
                      "first frame saves": savedText(record.first_frame_saves), "later ones save": savedText(record.later_frames_save),
                      "same image": sameImage(record) };
      return h("dl", { class: "cell" }, Object.entries(lines).map(([what, value]) => [h("dt", null, what), h("dd", null, value)]));
    }
    const unsuited = scene.unsuited.find(one => one.pipeline === pipeline);
    if (unsuited) return h("span", { class: "soft" }, "not run: " + unsuited.why);
    const failed = scene.points.find(point => point.pipeline === pipeline && point.failure);
    return failed ? bad("failed: " + failed.failure) : h("span", { class: "soft" }, "not measured");
  }

  function neededMatrix() {
    const pipelines = [...new Set(data.scenes.flatMap(scene => scene.points.concat(scene.unsuited).map(one => one.pipeline)))].sort();
    return [
      h("h2", { id: "needed" }, "What was needed"),
      caption("Each pipeline as it runs on each scene, beside the same with everything kept. Passes kept of all that the text has; shader "
        + "variants needed / compiled / possible; memory and time that leaving out saves. A later frame follows another while the camera "
        + "moves, and runs only what changed. Leaving out may change the cost, never the image: both are compared bit for bit. Under "
        + "each scene below: what was left out, and why."),
      table([{ title: "Scene" }, ...pipelines.map(pipeline => ({ title: shortName(pipeline), kind: "cell" }))],
            data.scenes.map(scene => [sceneTitle(scene), ...pipelines.map(pipeline => neededCell(scene, pipeline))]))];
  }

  // ---- one scene

  function reference(scene) {
    const { samples_per_pixel: samples, seconds, layers, attributes } = scene.reference;
    return [
      h("p", null, `${scene.triangles} triangles, camera “${scene.camera}”, ${scene.width} × ${scene.height} pixels, time ${scene.time_s} s. `
        + `Reference: path tracing with ${samples} samples per pixel${seconds >= 0.1 ? " (" + number(seconds) + " s)" : ""}. Scene hash `,
        h("code", null, scene.hash), "."),
      folded("The reference's own noise",
        table(columns("Reference layer", ["Noise (RMS)", "number"], ["Mean", "number"], ["Noise / mean", "number"], ["Largest", "number"],
                      ["Exposure (EV)", "number"]),
              layers.map(layer => [layer.layer, number(layer.noise), number(layer.mean),
                                   layer.mean > 0 ? percent(layer.noise / layer.mean) : "-", number(layer.largest),
                                   layer.exposure_ev.toFixed(2)])),
        h("dl", null, Object.entries(attributes).map(([name, value]) => [h("dt", null, name), h("dd", null, value)])))];
  }

  function errors(scene) {
    const rows = scene.points.flatMap(point => point.errors.map(error => {
      const oneReference = error.kind === "bias" && !point.errors.some(other => other.output === error.output && other.kind === "miss");
      const pair = name => measured({ value: error[name], uncertainty: error[name + "_uncertainty"] });
      return { kind: rowKind(point), cells: [
        shortName(point.pipeline), parametersText(point.parameters), outputName(error.output), error.reference,
        oneReference ? "error" : error.kind === "bias" ? "bias" : "misses", measured(error.rmse), number(error.ratio_to_nothing),
        measured(error.mean_ratio), measured(error.mean_difference), measured(error.relative_mse), pair("percentile_95"), pair("ssim"),
        pair("flip_hdr"), pair("flip_ldr"), number(error.reference_noise),
        error.seeds < 2 ? "one seed" : error.deterministic ? "none" : number(error.image_noise),
        error.non_finite_image === 0 ? "0" : bad(error.non_finite_image)] };
    }));
    return [
      h("h3", null, "Error numbers"),
      caption("RMSE, mean difference and percentile in W/(sr m²). “Of left out” is the RMSE divided by that of a black image: below 1 the "
        + "component is better than none. Mean ratio is the image's energy over the reference's. Pixels that are NaN or infinite are counted "
        + "and left out of the numbers. SSIM and FLIP LDR are taken at " + exposureText(scene) + ". Numbers after ± are one standard uncertainty. Bold rows are the default parameters."),
      table(columns("Pipeline", "Parameters", "Output", "Reference", "Says", ["RMSE", "number"], ["of left out", "number"], ["Mean ratio", "number"],
                    ["Mean difference", "number"], ["Relative MSE", "number"], ["95th percentile", "number"], ["SSIM", "number"],
                    ["FLIP HDR", "number"], ["FLIP LDR", "number"], ["Reference's noise", "number"], ["Image's noise", "number"],
                    ["NaN, Inf", "number"]), rows)];
  }

  function noise(scene) {
    const moves = scene.points.some(point => point.errors.some(error => error.flicker.value !== null));
    const parts = defaults => table([
      { title: "Pipeline" }, ...(defaults ? [] : [{ title: "Parameters" }]), { title: "Output" }, { title: "Against" },
      ...["RMSE", "Bias", "Image's noise", "Reference's noise", ...(moves ? ["Flicker"] : []), "Seeds"].map(title => ({ title, kind: "number" }))],
      scene.points.filter(point => point.default === defaults).flatMap(point => point.errors.map(error => [
        shortName(point.pipeline), ...(defaults ? [] : [parametersText(point.parameters)]), outputName(error.output), error.reference,
        measured(error.rmse), error.seeds < 2 ? "one seed" : measured(error.rms_bias),
        error.seeds < 2 ? "one seed" : error.deterministic ? "none" : measured(error.rms_noise), number(error.reference_noise),
        ...(moves ? [measured(error.flicker)] : []), error.seeds])));
    const others = scene.points.some(point => !point.default && point.errors.length > 0);
    return [
      h("h3", null, "Bias and noise apart"),
      caption("What the RMSE is made of: the squares of bias, of the image's own noise and of the reference's noise add up to the mean square "
        + "over seeds. More samples or more frames take the image's noise away, never the bias. Techniques without random numbers have "
        + "none; two seeds alone estimate the noise only roughly, and the uncertainties are then bounds."
        + (moves ? " Flicker: RMS of the changes from frame to frame, 1/24 s apart, that the reference does not make, its noise taken off." : "")
        + " All in W/(sr m²), ± one standard uncertainty."),
      parts(true), others && folded("Other points of the sweeps", parts(false))];
  }

  function slopes(scene) {
    if (scene.slopes.length === 0) return null;
    return [
      h("h3", null, "Convergence"),
      caption("Over each parameter that takes three values or more, the others fixed: the slope of log error, or log time, against the log of "
        + "the parameter, by least squares. An error that falls in proportion to the voxel's size has the slope -1 over the resolution, "
        + "noise -0.5 over the number of samples. Errors are RMSE without the reference's noise. The plateau, from four values on, is what stays "
        + "however large the parameter becomes (of times: however small), as far as the fit of plateau plus power can tell; “none”: not "
        + "above twice its uncertainty."),
      table(columns("Pipeline", "Parameter", "Others", "Output", "Quantity", ["Slope", "number"], ["Plateau", "number"],
                    ["Slope above it", "number"], ["Values", "number"]),
            scene.slopes.map(slope => [
              shortName(slope.pipeline), slope.parameter + " " + lumivox.significant(slope.low, 4) + " .. " + lumivox.significant(slope.high, 4),
              slope.others, slope.output === "" ? "whole frame" : outputName(slope.output), slope.quantity, measured(slope.slope),
              slope.has_plateau ? measured(slope.plateau) : slope.plateau.value === null ? "-" : "none",
              slope.has_plateau ? number(slope.slope_above_plateau) : "-", slope.values]))];
  }

  // ---- time and memory

  function passChart(scene, of, unit, text, name) {
    const points = scene.points.filter(point => !point.failure);
    const passes = [...new Set(points.flatMap(point => point.passes.map(pass => pass.pass)))];
    const configuration = () => {
      const datasets = passes.map((name, index) => ({ label: name, backgroundColor: palette[index % palette.length], data: points.map(point => {
        const pass = point.passes.find(one => one.pass === name);
        return pass ? of(pass) : 0;
      }) }));
      if (unit === "ms")
        datasets.push({ label: "between passes", backgroundColor: "#c4cbd4", data: points.map(point => point.framework_share * point.frame_ms.median) });
      return {
        type: "bar", data: { labels: points.map(point => [shortName(point.pipeline), parametersText(point.parameters)]), datasets },
        options: {
          indexAxis: "y", animation: false, maintainAspectRatio: false,
          scales: { x: { stacked: true, title: { display: true, text } }, y: { stacked: true } },
          plugins: { legend: { position: "bottom", labels: { boxWidth: 14, font: { size: 11 } } },
                     tooltip: { callbacks: { label: item => item.dataset.label + ": " + number(item.raw) + " " + unit } } } } };
    };
    return h("figure", null, chart(configuration, { "data-chart": name }, { height: 140 + 48 * scene.points.length }).frame);
  }

  function passTable(points) {
    const passes = [...new Set(points.flatMap(point => point.passes.map(pass => pass.pass)))];
    const of = (point, name) => point.passes.find(one => one.pass === name);
    const row = (title, time, memory, kind) => ({ kind, cells: [title, ...points.map(time), ...points.map(memory)] });
    return table(
      [{ title: "Pass" }, ...points.map(point => ({ title: parametersText(point.parameters) + ": ms", kind: "number" })),
       ...points.map(point => ({ title: parametersText(point.parameters) + ": memory", kind: "number" }))],
      [...passes.map(name => row(name, point => of(point, name) ? quartiles(of(point, name).device_ms) : "-",
                                 point => of(point, name) ? bytes(of(point, name).bytes) : "-")),
       row("whole frame; most memory at once", point => quartiles(point.frame_ms), point => bytes(point.peak_bytes), "total"),
       row("between passes (the framework)", point => percent(point.framework_share), () => ""),
       row("next frame, only what changed", point => quartiles(point.next_frame_ms), () => ""),
       row("done once (preprocessing)", point => measured(point.once_ms, milliseconds), () => ""),
       row("done when the camera or a light moves", point => measured(point.when_moving_ms, milliseconds), () => ""),
       row("done in every frame", point => measured(point.every_frame_ms, milliseconds), () => "")]);
  }

  /** The operations that there are most of: "12.3 M texture samples d3 rgba16f mips; 4.56 M buffer reads". */
  const workText = work => Object.entries(work).filter(([, count]) => count > 0).sort((a, b) => b[1] - a[1]).slice(0, 6)
    .map(([name, count]) => thousands(count) + " " + words(name)).join("; ");

  function limitTable(point) {
    return table(columns("Pass", ["ms", "number"], ["Share of the frame", "number"], "Limited by", ["At least, ms", "number"],
                         ["Of the peak rate", "number"], ["One after the other", "number"], ["Does", "wide"]),
      point.passes.map(pass => {
        const ms = pass.device_ms ? pass.device_ms.median : 0, limit = pass.limit || {}, least = limit.at_least_ms;
        return [pass.pass, number(ms), point.frame_ms.median > 0 ? percent(ms / point.frame_ms.median) : "-", limit.limited_by || "-",
                least ? number(least[limit.limited_by]) : "-", least ? percent(limit.of_peak_rate) : "-",
                least ? percent(Object.values(least).reduce((sum, one) => sum + one, 0) / ms) : "-", limit.work ? workText(limit.work) : ""];
      }));
  }

  function times(scene) {
    const pipelines = [...new Set(scene.points.map(point => point.pipeline))];
    return [
      h("h3", null, "Time and memory per pass"),
      caption("Medians over repeats of frames in which every kept pass runs; quartiles in brackets. Measured apart from the images above. "
        + "What a pass does was counted in a frame of its own; with the peak rates of this device it gives the time that the pass takes at "
        + "least: on the resource that limits it, and on all of them one after the other, as a device that overlaps nothing would need. The "
        + "last three rows take a first frame apart: what is done once, what is done again when the camera and the lights have moved, and "
        + "what every frame costs. A point of several accumulated frames holds all of them."),
      h("div", { class: "charts" },
        passChart(scene, pass => pass.device_ms ? pass.device_ms.median : 0, "ms", "time per pass, ms", "time"),
        passChart(scene, pass => pass.bytes / 1048576, "MiB", "memory taken per pass, MiB", "bytes")),
      pipelines.map(pipeline => {
        const points = scene.points.filter(point => point.pipeline === pipeline && !point.failure);
        if (points.length === 0) return null;
        const uncounted = points.find(point => point.why_not_counted);
        const counted = points.filter(point => !point.why_not_counted), others = counted.filter(point => !point.default);
        return [
          h("h4", null, shortName(pipeline)), passTable(points),
          uncounted && h("p", null, "What the passes do was not counted: " + uncounted.why_not_counted + "."),
          counted.filter(point => point.default).map(point => [h("p", null, "How far from the limit, at the default parameters:"), limitTable(point)]),
          others.length > 0 && folded("How far from the limit at the other points",
            others.map(point => [h("h4", null, parametersText(point.parameters)), limitTable(point)]))];
      })];
  }

  // ---- what was left out, and the rest

  function needed(scene) {
    return [
      h("h3", null, "What was left out, and what that saved"),
      caption("The pipeline as it runs and the same with everything kept, timed alternately at the default parameters. Leaving out may change "
        + "the cost, never the image."),
      scene.pruning.map(record => [
        h("h4", null, shortName(record.pipeline)),
        h("p", null, quartiles(record.frame_ms), " ms instead of ", quartiles(record.frame_ms_keep_everything), " ms: ",
          h("b", null, percent(record.saved_share)), " of the time of a first frame saved; ", quartiles(record.next_frame_ms),
          " ms instead of ", quartiles(record.next_frame_ms_keep_everything), " ms: ", h("b", null, percent(record.saved_share_next)),
          ` of that of a frame that follows another while the camera moves. ${record.passes_kept} of ${record.passes_total} passes kept; `
          + `shader variants: ${record.variants.possible} possible, ${record.variants.compiled} compiled, ${record.variants.needed} needed. `
          + `Memory taken by the passes: ${bytes(record.bytes)} instead of ${bytes(record.bytes_keep_everything)}. Same image, bit for bit: `,
          sameImage(record), "."),
        record.left_out.length > 0 && table(
          columns("Level", "Left out", ["Why", "wide"], ["Saved memory", "number"], ["Saved ms", "number"]),
          record.left_out.map(one => [one.level, one.what, one.why, one.saved_bytes === 0 ? "" : bytes(one.saved_bytes),
                                      one.saved_ms ? number(one.saved_ms) : ""])),
        folded("Pass by pass", table(
          columns("Pass", ["as it runs, ms", "number"], ["everything kept, ms", "number"], ["saved, ms", "number"]),
          record.passes.map(pass => [pass.pass, timesOf(pass.ms) ? quartiles(pass.ms) : "left out", quartiles(pass.ms_keep_everything),
                                     number((pass.ms_keep_everything ? pass.ms_keep_everything.median : 0) - (pass.ms ? pass.ms.median : 0))])))]),
      scene.left_out_prunings.length > 0 && h("p", null, "There was no time to measure this for: "
        + scene.left_out_prunings.map(shortName).join(", ") + "."),
      scene.unsuited.length > 0 && [h("p", null, "Committed pipelines that do not suit this scene:"),
                                    list(scene.unsuited.map(one => shortName(one.pipeline) + ": " + one.why))]];
  }

  function health(scene) {
    const items = scene.points.flatMap(point => {
      const place = shortName(point.pipeline) + " (" + parametersText(point.parameters) + "): ";
      return [...(point.failure ? [bad(place + point.failure)] : []), ...point.health_findings.map(finding => place + finding)];
    });
    const notes = scene.points.filter(point => point.default).flatMap(point => point.notes.map(note => shortName(point.pipeline) + ", " + note));
    return [
      h("h3", null, "Health"),
      items.length > 0 ? list(items)
                       : h("p", null, "Every output of every pass was scanned for NaN, Inf and negative values: none was found."),
      notes.length > 0 && [h("p", null, "What passes tell of themselves:"), list(notes)]];
  }

  const commands = scene => [h("h3", null, "Commands that repeat the points"), scene.points.map(point => h("pre", null, point.command))];

  const scenes = data.scenes.map((scene, index) => [
    h("h2", { id: "scene-" + index }, sceneTitle(scene)), reference(scene), comparisonSection(scene), imageSection(scene, index),
    errors(scene), noise(scene), slopes(scene), times(scene), needed(scene), health(scene), commands(scene)]);

  // ---- where it comes from

  function peakRates() {
    if (data.peak_rates.length === 0)
      return h("p", null, "What this device can do at most is not known: ", h("code", null, "lumivox device"),
               " measures it, once, and the next report says how far each pass is from it.");
    return folded("What this device can do at most",
      table(columns("What", ["At most", "number"], ["Quartiles", "number"], "Unit", "Measured"),
            data.peak_rates.map(one => [words(one.name), thousands(one.median), thousands(one.lower_quartile) + " .. " + thousands(one.upper_quartile),
                                      one.unit, one.created])));
  }

  function provenance() {
    const device = data.device, code = text => h("code", null, text);
    const items = { Device: device.renderer + (device.software ? " (a software rasteriser)" : ""), Vendor: device.vendor, Driver: device.version,
                    Platform: device.platform, Host: device.host, Shaders: device.shaders,
                    Timer: (device.timer_queries_trusted ? "timer queries; " : "fenced clock; ") + device.timer_note, Date: data.date };
    return [
      h("h2", { id: "device" }, "Device, driver and contents"),
      h("dl", null, Object.entries(items).map(([title, value]) => [h("dt", null, title), h("dd", null, value)])), peakRates(),
      table(columns("Kind", "Name", "File", "Hash"), [
        ...data.scenes.map(scene => ["scene", scene.name, scene.file, code(scene.hash)]),
        ...data.pipelines.map(pipeline => ["pipeline", pipeline.name, pipeline.file, code(pipeline.hash)]),
        ...data.techniques.flatMap(technique => [["technique", technique.name, technique.paper, code(technique.library_hash)],
                                                 ["shaders", technique.name, "", code(technique.shader_hash)]])]),
      data.skipped.length > 0 && [h("p", null, "Technique libraries that were skipped:"),
                                  list(data.skipped.map(one => one.library + ": " + one.reason))],
      data.command && [h("p", null, "This page was made by"), h("pre", null, data.command)]];
  }

  const left = data.scenes.reduce((sum, scene) => sum + scene.left_out_points.length, 0);
  const outOfTime = left === 0 ? "" : ` Measured within a budget of ${data.budget_s} s, default points first: for ${left} points of sweeps there `
    + "was no time; they are named below.";
  const link = (id, title) => h("a", { href: "#" + id }, title);
  show(
    h("header", null, h("h1", null, "Lumivox report"),
      h("p", { class: "soft" }, "How wrong, how fast, and what was left out. Measured on " + data.device.renderer + ", " + data.date
        + ". The same numbers are in the .csv and .json files beside this page." + outOfTime),
      h("nav", null, link("summary", "Summary"), link("needed", "What was needed"),
        data.scenes.map((scene, index) => link("scene-" + index, sceneTitle(scene))), data.voxels && link("voxels", "Voxels"),
        data.stress && link("stress", "Where it breaks"), link("device", "Device and contents"))),
    h("main", null, summary(), neededMatrix(), scenes, data.voxels && voxelSection(data.voxels, data.voxel_scaling),
      data.stress && stressSection(data.stress, ""), provenance()));
})();
