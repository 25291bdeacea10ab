"use strict";
// The page of a report: of each scene first one screen that tells how wrong, how fast, what breaks and what was needed, then the
// sections with every number.
(function () {
  const { data, images, h, caption, list, longList, folded, plural, counted, section, table, sortedBy, number, milliseconds, percent, bytes,
          exposureText, thousands, measured, quartiles, soft, shortName, broken, pipelineName, words, parametersText, outputName, listed, swatch, show } = lumivox;
  const sceneTitle = scene => scene.name || scene.file;
  const timesOf = time => time && time.repeats > 0;
  const good = text => h("span", { class: "good" }, text);
  const bad = text => h("span", { class: "bad" }, text);
  const columns = (...titles) => titles.map(title => typeof title === "string" ? { title }
    : { title: title[0], kind: title[1], hidden: title[2] === "hidden" });
  const named = file => [swatch(file), pipelineName(file)];
  const rowOf = (point, cells) => ({ kind: point.default ? "default" : "", pipeline: point.pipeline, isDefault: point.default, cells });

  /** The parameters in which a point differs from the default one of its pipeline; all of them in the title. */
  function pointParameters(scene, point) {
    const standard = scene.points.find(other => other.default && other.pipeline === point.pipeline);
    const differing = Object.fromEntries(Object.entries(point.parameters).filter(([name, value]) =>
      !point.default && !(standard && standard.parameters[name] === value)));
    return h("span", { title: parametersText(point.parameters) }, parametersText(differing));
  }
  function errorOf(point, component, against) {
    const own = point.errors.filter(error => error.component === component && (component !== "final" || error.output === "whole_image"));
    return own.find(error => error.against === against) || own[0];
  }

  // ---- one screen for each scene

  /** What breaks, in a sentence. */
  function breaks(scene) {
    const failed = scene.points.filter(point => point.failure), ill = scene.points.filter(point => point.health_findings.length > 0);
    const names = points => listed([...new Set(points.map(point => shortName(point.pipeline)))]);
    const here = failed.length === 0 && ill.length === 0
      ? `nothing in this scene: no NaN, infinite or negative value in any output of ${plural(scene.points.length, "point")}.`
      : [failed.length > 0 && bad(plural(failed.length, "point") + " of " + names(failed) + " failed. "),
         ill.length > 0 && bad(plural(ill.length, "point") + " of " + names(ill) + " made values that are NaN, infinite or negative.")];
    const own = (data.stress || []).filter(cell => scene.points.some(point => shortName(point.pipeline) === shortName(cell.pipeline)));
    const outcome = name => own.filter(cell => cell.outcome === name);
    const told = [["broken", "are broken"], ["diverges", "diverge"], ["biased", "are biased"]].map(([name, verb]) => [outcome(name), verb])
      .filter(([cells]) => cells.length > 0).map(([cells, verb]) => cells.length + " " + verb + " ("
        + listed([...new Set(cells.map(cell => shortName(cell.pipeline)))]) + ")");
    const battery = !data.stress ? [" The stress battery has not been run into this report's store: ", h("code", null, "lumivox stress"), "."]
      : [" Of ", plural(own.length, "cell"), " of the ", images.brief ? "stress battery" : h("a", { href: "#stress" }, "stress battery"), " ",
         told.length > 0 ? listed(told) : "none is broken, diverges or is biased", "."];
    return h("p", null, h("b", null, "What breaks: "), here, battery);
  }

  /** What was needed, in a sentence. */
  function neededSentence(scene) {
    const own = scene.pruning;
    if (own.length === 0) return h("p", null, h("b", null, "What was needed: "), data.complete ? "not measured." : "to come.");
    const timed = own.filter(one => one.first_frame_saves.told !== "not_timed").length;
    const sum = member => own.reduce((total, one) => total + one[member], 0);
    const savings = own.filter(one => one.first_frame_saves.told === "saved")
      .map(one => ({ name: shortName(one.pipeline), share: one.first_frame_saves.ms / one.first_frame_saves.of_ms }))
      .sort((a, b) => b.share - a.share);
    const differing = own.filter(one => !one.same_image);
    const standing = own.filter(one => one.standing_saves.told === "saved")
      .map(one => ({ name: shortName(one.pipeline), share: one.standing_saves.ms / one.standing_saves.of_ms })).sort((a, b) => b.share - a.share)[0];
    const kept = sum("passes_kept"), all = sum("passes_total"), those = plural(own.length, "pipeline");
    const saved = Math.max(0, sum("bytes_keep_everything") - sum("bytes")), isWhole = kept === all;
    // What is left out within passes, such as outputs and variants of shaders, may save time and memory, too.
    const rest = isWhole ? "What is left out within them" : "leaving out the rest";
    const ofTime = savings.length > 0 ? `saves up to ${percent(savings[0].share)} of a first frame (${savings[0].name})`
      : timed > 0 ? "saves no time that could be measured" : "saves a time that was not measured";
    const ofImages = differing.length === 0 ? "changes no image by a single bit."
      : bad("CHANGES the image of " + listed(differing.map(one => shortName(one.pipeline))) + ".");
    const nothing = isWhole && saved === 0 && savings.length === 0 && differing.length === 0;
    return h("p", null, h("b", null, "What was needed: "),
      isWhole ? `all ${plural(all, "pass", "passes")} of ${those}. ` : `${kept} of ${all} passes of ${those}; `,
      nothing ? "Nothing is left out that could be measured." : [`${rest} ${ofTime} and ${bytes(saved)} of memory, and `, ofImages],
      standing && ` While the camera moves, what stands still saves up to ${percent(standing.share)} of a first frame (${standing.name}).`);
  }

  /** Number, camera, size and reference, in a line. */
  function sceneLine(scene) {
    const { samples_per_pixel: samples, seconds } = scene.reference;
    return h("p", { class: "caption" }, `${thousands(scene.triangles)} triangles, camera “${scene.camera}”, ${scene.width} × ${scene.height} pixels, `
      + `time ${scene.time_s} s; reference: path tracing with ${plural(samples, "sample")} per pixel${seconds >= 0.1 ? " (" + number(seconds) + " s)" : ""}.`);
  }

  function overview(scene, index, compared) {
    const chosenRow = () => {
      const comparison = compared.chosen();
      if (!comparison) return null;
      const layer = scene.reference.layers.find(one => comparison.reference.split(", ").includes(one.layer));
      return [imagesOf.row(scene, index, comparison),
              layer && h("p", { class: "caption" }, "Default parameters, shown at " + exposureText(scene) + ".")];
    };
    const row = h("div", { class: "images" }, chosenRow());
    compared.follow(() => row.replaceChildren(h("div", null, chosenRow())));
    return h("div", { class: "overview" }, sceneLine(scene),
      h("div", { class: "two" }, compared.plot,
        h("div", { class: "defaults" }, compared.defaults, compared.equal && h("p", { class: "caption" }, compared.equal))),
      row, h("div", { class: "told-of" }, breaks(scene), neededSentence(scene)));
  }

  // ---- the sections of a scene

  function errors(scene) {
    const rows = scene.points.flatMap(point => point.errors.map(error => {
      const oneReference = error.against === "bias" && !point.errors.some(other => other.output === error.output && other.against === "misses");
      const of = name => sortedBy(error.metrics[name].value, measured(error.metrics[name]));
      return rowOf(point, [
        named(point.pipeline), pointParameters(scene, point), broken(outputName(error.output)), broken(error.reference),
        oneReference ? "error" : error.against, of("flip"), of("rmse"), number(error.ratio_to_nothing),
        of("relative_mse"), of("percentile95"), of("mean_ratio"), of("bias"), of("ssim"), of("flip_ldr"),
        number(error.metrics.noise_floor.value), error.deterministic ? "none" : error.seeds < 2 ? "one seed" : number(error.noise_rmse),
        error.metrics.non_finite_image.value === 0 ? "0" : bad(error.metrics.non_finite_image.value)]);
    }));
    return [
      caption("RMSE, mean difference and percentile in W/(sr m²). “Of left out” is the RMSE divided by that of a black image: below 1 the "
        + "component is better than none. Mean ratio is the image's energy over the reference's. Pixels that are NaN or infinite are counted "
        + "and left out of the numbers. SSIM and FLIP LDR are taken at " + exposureText(scene) + ". Numbers after ± are one standard "
        + "uncertainty. Bold rows are the default parameters."),
      table(columns("Pipeline", "Parameters", "Output", "Reference", "Says", ["FLIP", "number"], ["RMSE", "number"], ["of left out", "number"],
                    ["Relative MSE", "number"], ["95th percentile", "number"], ["Mean ratio", "number"], ["Mean difference", "number", "hidden"],
                    ["SSIM", "number", "hidden"], ["FLIP LDR", "number", "hidden"], ["Reference's noise", "number", "hidden"],
                    ["Image's noise", "number", "hidden"], ["NaN, Inf", "number", "hidden"]), rows)];
  }

  function noise(scene) {
    const moves = scene.points.some(point => point.errors.some(error => error.metrics.flicker.value !== null));
    const of = one => sortedBy(one.value, measured(one));
    return [
      caption("What the RMSE is made of: the squares of bias, of the image's own noise and of the reference's noise add up to the mean square "
        + "over seeds. More samples or more frames take the image's noise away, never the bias. Techniques without random numbers have "
        + "none; two seeds alone estimate the noise only roughly, and the uncertainties are then bounds."
        + (moves ? " Flicker: RMS of the changes from frame to frame, 1/24 s apart, that the reference does not make, its noise taken off." : "")
        + " All in W/(sr m²), ± one standard uncertainty."),
      table(columns("Pipeline", "Parameters", "Output", "Against",
                    ...["RMSE", "Bias", "Image's noise", "Reference's noise", ...(moves ? ["Flicker"] : []), "Seeds"].map(title => [title, "number"])),
        scene.points.flatMap(point => point.errors.map(error => rowOf(point, [
          named(point.pipeline), pointParameters(scene, point), broken(outputName(error.output)), broken(error.reference), of(error.metrics.rmse),
          error.seeds < 2 ? "one seed" : of(error.metrics.rms_bias),
          error.deterministic ? "none" : error.seeds < 2 ? "one seed" : of(error.metrics.rms_noise), number(error.metrics.noise_floor.value),
          ...(moves ? [of(error.metrics.flicker)] : []), error.seeds]))))];
  }

  function slopes(scene) {
    if (scene.slopes.length === 0) return [h("p", null, "No parameter takes three values or more while the others stay.")];
    return [
      caption("Over each parameter that takes three values or more, the others fixed: the slope of log error, or log time, against the log of "
        + "the parameter, by least squares. An error that falls in proportion to the voxel's size has the slope -1 over the resolution, "
        + "noise -0.5 over the number of samples. Errors are RMSE without the reference's noise. The plateau, from four values on, is what stays "
        + "however large the parameter becomes (of times: however small), as far as the fit of plateau plus power can tell; “none”: not "
        + "above twice its uncertainty."),
      table(columns("Pipeline", "Parameter", ["Others", "wide", "hidden"], "Output", "Quantity", ["Slope", "number"], ["Plateau", "number"],
                    ["Slope above it", "number"], ["Values", "number"]),
            scene.slopes.map(slope => ({ pipeline: slope.pipeline, cells: [
              named(slope.pipeline), slope.parameter + " " + lumivox.significant(slope.low, 4) + " .. " + lumivox.significant(slope.high, 4),
              slope.others, slope.output === "" ? "whole frame" : broken(outputName(slope.output)), slope.quantity,
              sortedBy(slope.slope.value, measured(slope.slope)),
              slope.has_plateau ? sortedBy(slope.plateau.value, measured(slope.plateau)) : slope.plateau.value === null ? "-" : "none",
              slope.has_plateau ? number(slope.slope_above_plateau) : "-", slope.values] })))];
  }

  /** Bars of the default points, divided by passes. Beyond eight passes the smallest are one part. */
  function passBars(scene, title, of, rest, text) {
    const points = scene.points.filter(point => point.default && !point.failure), totals = new Map();
    for (const point of points) for (const pass of point.passes) totals.set(pass.name, (totals.get(pass.name) || 0) + of(pass));
    const largest = [...totals].filter(([, total]) => total > 0).sort((a, b) => b[1] - a[1]).map(([name]) => name).slice(0, 8);
    const parts = point => {
      const sum = wanted => point.passes.filter(pass => wanted(pass.name)).reduce((total, pass) => total + of(pass), 0);
      const own = largest.map((name, index) => ({ name, kind: "pass-" + index, value: sum(one => one === name) }));
      own.push({ name: "other passes", kind: "pass-other", value: sum(one => !largest.includes(one)) });
      if (rest) own.push({ name: "between passes", kind: "pass-between", value: rest(point) });
      return own.filter(part => part.value > 0);
    };
    const sums = points.map(point => parts(point).reduce((sum, part) => sum + part.value, 0)), most = Math.max(...sums, Number.MIN_VALUE);
    const used = new Map(points.flatMap(parts).map(part => [part.name, part.kind]));
    return h("figure", { class: "bars" }, h("figcaption", null, h("b", null, title)),
      points.map((point, at) => h("div", { class: "bar" }, h("div", { class: "bar-name" }, pipelineName(point.pipeline)),
        h("div", { class: "bar-parts", role: "img",
                   "aria-label": shortName(point.pipeline) + ": " + parts(point).map(part => part.name + " " + text(part.value)).join(", ") },
          parts(point).map(part => h("span", { class: part.kind, style: "width:" + (100 * part.value / most).toFixed(3) + "%",
                                               title: part.name + ": " + text(part.value) }))),
        h("div", { class: "bar-total" }, text(sums[at])))),
      h("ul", { class: "legend" }, [...used].map(([name, kind]) => h("li", null, h("span", { class: "key " + kind }), broken(name)))));
  }

  /** The operations that there are most of: "12.3 M texture samples d3 rgba16f mips; 4.56 M buffer reads". */
  const workText = work => Object.entries(work).filter(([, count]) => count > 0).sort((a, b) => b[1] - a[1]).slice(0, 6)
    .map(([name, count]) => thousands(count) + " " + words(name)).join("; ");

  function times(scene) {
    const points = scene.points.filter(point => !point.failure), uncounted = points.filter(point => point.not_counted);
    const of = (one, text) => sortedBy(one.value, measured(one, text)), timed = time => sortedBy(time && time.median, quartiles(time));
    const saysLimits = points.some(point => point.passes.some(pass => pass.at_least_ms));
    const passRows = points.flatMap(point => point.passes.map(pass => {
      const ms = pass.device_ms ? pass.device_ms.median : 0, least = pass.at_least_ms;
      return rowOf(point, [named(point.pipeline), pointParameters(scene, point), broken(pass.name), timed(pass.device_ms),
        point.frame_ms.median > 0 ? percent(ms / point.frame_ms.median) : "-", sortedBy(pass.bytes, bytes(pass.bytes)), pass.limited_by || "-",
        least ? number(least[pass.limited_by]) : "-", least ? percent(pass.of_peak_rate) : "-",
        least ? percent(Object.values(least).reduce((sum, one) => sum + one, 0) / ms) : "-", pass.work ? workText(pass.work) : ""]);
    }));
    const seen = saysLimits ? undefined : "hidden";
    return [
      caption("Medians over repeats of frames in which every kept pass runs; quartiles in brackets. Measured apart from the images. "
        + "“Once”, “when moving” and “every frame” take a first frame apart: what is done once (preprocessing), what is done again when the "
        + "camera and the lights have moved, and what every frame costs. A point of several accumulated frames holds all of them."),
      h("div", { class: "two" },
        passBars(scene, "Time per pass at the default parameters", pass => pass.device_ms ? pass.device_ms.median : 0,
                 point => point.framework_share * point.frame_ms.median, value => milliseconds(value) + " ms"),
        passBars(scene, "Memory taken per pass at the default parameters", pass => pass.bytes || 0, null, bytes)),
      h("h4", null, "Whole frames"),
      table(columns("Pipeline", "Parameters", ["Frame, ms", "number"], ["Next frame, only what changed, ms", "number"], ["Once, ms", "number"],
                    ["When moving, ms", "number"], ["Every frame, ms", "number"], ["Between passes", "number"], ["Most memory at once", "number"]),
        points.map(point => rowOf(point, [named(point.pipeline), pointParameters(scene, point), timed(point.frame_ms), timed(point.next_frame_ms),
          of(point.once_ms, milliseconds), of(point.when_moving_ms, milliseconds), of(point.every_frame_ms, milliseconds),
          percent(point.framework_share), sortedBy(point.peak_bytes, bytes(point.peak_bytes))]))),
      h("h4", null, "Passes"),
      caption("What a pass does was counted in a frame of its own; with the peak rates of this device it gives the time that the pass takes at "
        + "least: on the resource that limits it, and on all of them one after the other, as a device that overlaps nothing would need."),
      uncounted.length > 0 && h("p", null, "What the passes do was not counted: " + uncounted[0].not_counted + "."),
      table(columns("Pipeline", "Parameters", "Pass", ["Time, ms", "number"], ["Share of the frame", "number"], ["Memory", "number"],
                    ["Limited by", undefined, seen], ["At least, ms", "number", seen], ["Of the peak rate", "number", seen],
                    ["One after the other", "number", "hidden"], ["Does", "wide", "hidden"]), passRows)];
  }

  // ---- what was needed

  function savedText(saved) {
    if (saved.told === "not_timed") return soft("not timed");
    if (saved.told === "undecided") return "undecided with fewer than " + data.least_repeats + " repeats, of " + milliseconds(saved.of_ms) + " ms";
    if (saved.told === "not_measurable") return "not measurable, of " + milliseconds(saved.of_ms) + " ms";
    return milliseconds(saved.ms) + " of " + milliseconds(saved.of_ms) + " ms";
  }
  const sameImage = record => record.same_image ? good("yes") : bad("NO");

  /** Every pipeline on a scene: what it needed, or why it was not run. */
  function neededRows(scene) {
    const files = [...new Set(scene.points.concat(scene.unsuited).map(one => one.pipeline))].sort();
    return files.map(file => {
      const record = scene.pruning.find(one => one.pipeline === file);
      if (record)
        return [pipelineName(file), record.passes_kept + " of " + record.passes_total,
                record.variants_needed + " / " + record.variants_compiled + " / " + record.variants_possible,
                bytes(Math.max(0, record.bytes_keep_everything - record.bytes)) + " of " + bytes(record.bytes_keep_everything),
                savedText(record.first_frame_saves), savedText(record.standing_saves), sameImage(record)];
      const unsuited = scene.unsuited.find(one => one.pipeline === file);
      const failed = scene.points.find(point => point.pipeline === file && point.failure);
      const why = unsuited ? "not run: " + unsuited.why : failed ? bad("failed: " + failed.failure) : soft("not measured");
      return [pipelineName(file), "-", "-", "-", "-", "-", why];
    });
  }

  function needed(scene) {
    return [
      caption("Each pipeline as it runs on the scene, beside the same with everything kept, timed alternately at the default parameters. "
        + "Passes kept of all that the text has; shader variants needed / compiled / possible; memory that leaving out saves. Leaving out saves "
        + "time: a first frame against one with everything kept. Standing still saves time: a frame that follows another while the camera "
        + "moves, and runs only what changed, against a first frame with the same left out. Leaving out may change the cost, never the image: "
        + "both are compared bit for bit."),
      table(columns("Pipeline", "Passes", "Variants", "Memory left out", "Leaving out saves, of a first frame", "Standing still saves, of a first frame", ["Same image, bit for bit", "wide"]),
            neededRows(scene)),
      scene.left_out_prunings.length > 0 && h("p", null, "There was no time to measure this for: "
        + scene.left_out_prunings.map(shortName).join(", ") + "."),
      scene.pruning.some(record => record.left_out.length > 0) && [
        h("h4", null, "What was left out, and why"),
        table(columns("Pipeline", "Level", ["Left out", "wide"], ["Why", "wide"], ["Saved memory", "number"], ["Saved, ms", "number"]),
          scene.pruning.flatMap(record => record.left_out.map(one => ({ pipeline: record.pipeline, cells: [
            pipelineName(record.pipeline), one.level, one.what, one.why, sortedBy(one.saved_bytes, one.saved_bytes === 0 ? "" : bytes(one.saved_bytes)),
            sortedBy(one.saved_ms, one.saved_ms ? number(one.saved_ms) : "")] }))))],
      scene.pruning.some(record => record.passes.length > 0) && [
        h("h4", null, "Pass by pass"),
        table(columns("Pipeline", "Pass", ["As it runs, ms", "number"], ["Everything kept, ms", "number"], ["Saved, ms", "number"]),
          scene.pruning.flatMap(record => record.passes.map(pass => ({ pipeline: record.pipeline, cells: [
            pipelineName(record.pipeline), broken(pass.name), timesOf(pass.ms) ? quartiles(pass.ms) : "left out", quartiles(pass.ms_keep_everything),
            number((pass.ms_keep_everything ? pass.ms_keep_everything.median : 0) - (pass.ms ? pass.ms.median : 0))] }))))]];
  }

  function health(scene) {
    const items = scene.points.flatMap(point => {
      const place = shortName(point.pipeline) + " (" + parametersText(point.parameters) + "): ";
      return [...(point.failure ? [bad(place + point.failure)] : []), ...point.health_findings.map(finding => place + finding)];
    });
    const notes = scene.points.filter(point => point.default).flatMap(point => point.notes.map(note => shortName(point.pipeline) + ", " + note));
    return [
      items.length > 0 ? longList("What was found", items, "finding")
                       : h("p", null, "Every output of every pass was scanned for NaN, Inf and negative values: none was found."),
      notes.length > 0 && longList("What passes tell of themselves", notes, "note")];
  }

  const commands = scene => table(columns("Pipeline", ["All parameters", "wide"], ["Command that repeats the point", "wide"]),
    scene.points.map(point => rowOf(point, [named(point.pipeline), parametersText(point.parameters), h("code", null, point.command)])));

  function reference(scene) {
    const { layers, attributes } = scene.reference;
    return [
      h("p", null, "Scene ", h("code", null, scene.file), ", hash ", h("code", null, scene.hash), "."),
      layers.length > 0 && table(columns("Reference layer", ["Noise (RMS)", "number"], ["Mean", "number"], ["Noise / mean", "number"], ["Largest", "number"],
                    ["Exposure (EV)", "number"]),
            layers.map(layer => [broken(layer.layer), number(layer.noise), number(layer.mean),
                                 layer.mean > 0 ? percent(layer.noise / layer.mean) : "-", number(layer.largest), layer.exposure_ev.toFixed(2)])),
      h("dl", null, Object.entries(attributes).map(([name, value]) => [h("dt", null, name), h("dd", null, value)]))];
  }

  const link = (id, title) => h("a", { href: "#" + id }, title);
  function sceneParts(scene, index) {
    const id = name => "scene-" + index + (name ? "-" + name : "");
    const compared = comparisonOf(scene);
    const ofReference = ["reference", "Reference", "The reference and its noise", reference(scene)];
    const sections = images.brief ? [] : scene.points.length === 0 ? [
      ["fronts", "Fronts", "Fronts, equal time, equal error", compared.sections], ofReference] : [
      ["fronts", "Fronts", "Fronts, equal time, equal error", compared.sections],
      ["recall", "Recall", "Error against recall", compared.voxels()],
      ["images", "Images", "Images, reference and FLIP maps", imagesOf.all(scene, index)],
      ["errors", "Errors", "Error numbers", errors(scene)], ["noise", "Noise", "Bias and noise apart", noise(scene)],
      ["slopes", "Convergence", "Convergence", slopes(scene)], ["times", "Time and memory", "Time and memory per pass", times(scene)],
      ["needed", "What was needed", "What was needed", needed(scene)], ["health", "Health", "Health", health(scene)],
      ["commands", "Commands", "Parameters and commands", commands(scene)],
      ofReference].filter(([, , , content]) => content !== null);
    return h("section", { class: "scene", "aria-label": sceneTitle(scene) },
      h("div", { class: "scene-bar", id: id() }, h("h2", null, sceneTitle(scene)),
        sections.length > 0 && h("nav", { "aria-label": "sections of " + sceneTitle(scene) }, sections.map(([name, brief]) => link(id(name), brief)))),
      overview(scene, index, compared), sections.map(([name, , title, content]) => section(id(name), title, content)));
  }

  // ---- all scenes together

  function summary() {
    const rows = data.scenes.flatMap(scene => {
      const comparison = scene.comparisons.find(one => one.component === "final" && one.against === "misses" && one.metric === "flip");
      const front = new Set(comparison ? comparison.points.filter(point => point.beaten_by === null).map(point => point.source) : []);
      return scene.points.map((point, index) => {
        const error = errorOf(point, "final", "misses"), of = one => sortedBy(one.value, measured(one));
        return rowOf(point, [
          sceneTitle(scene), named(point.pipeline), pointParameters(scene, point), sortedBy(point.frame_ms.median, quartiles(point.frame_ms)),
          error ? of(error.metrics.flip) : "-", error ? of(error.metrics.rmse) : "-",
          error ? of(error.metrics.mean_ratio) : "-", front.has(index) ? "on the Pareto front" : "",
          point.failure ? bad("failed") : point.health_findings.length === 0 ? good("good") : bad(plural(point.health_findings.length, "finding"))]);
      });
    });
    return section("summary", "All scenes and points",
      caption("FLIP, RMSE and mean ratio of the whole image against full transport. " + data.units.flip + " Bold rows are the default parameters."),
      table(columns("Scene", "Pipeline", "Parameters", ["Frame, ms", "number"], ["FLIP", "number"], ["RMSE", "number"], ["Mean ratio", "number"],
                    "Front", "Health"), rows));
  }

  // ---- where it comes from

  function peakRates() {
    if (data.peak_rates.length === 0)
      return h("p", null, "What this device can do at most is not known: ", h("code", null, "lumivox device"),
               " measures it, once, and the next report says how far each pass is from it.");
    return folded(counted("What this device can do at most", data.peak_rates.length, "rate"),
      table(columns("What", ["At most", "number"], ["Quartiles", "number"], "Unit", "Measured"),
            data.peak_rates.map(one => [words(one.name), sortedBy(one.median, thousands(one.median)),
                                        thousands(one.lower_quartile) + " .. " + thousands(one.upper_quartile), one.unit, one.created])));
  }

  function provenance() {
    const device = data.device, code = text => h("code", null, text);
    const items = { Device: device.renderer + (device.software ? " (a software rasteriser)" : ""), Vendor: device.vendor, Driver: device.version,
                    Platform: device.platform, Host: device.host, Shaders: device.shaders,
                    Timer: (device.timer_queries_trusted ? "timer queries; " : "fenced clock; ") + device.timer_note, Date: data.date };
    return section("device", "Device, driver and contents",
      h("dl", null, Object.entries(items).map(([title, value]) => [h("dt", null, title), h("dd", null, value)])), peakRates(),
      table(columns("Kind", "Name", ["File or paper", "wide"], ["Hash", "wide"]), [
        ...data.scenes.map(scene => ["scene", scene.name, scene.file, code(scene.hash)]),
        ...data.pipelines.map(pipeline => ["pipeline", pipeline.name, pipeline.file, code(pipeline.hash)]),
        ...data.techniques.flatMap(technique => [["technique", broken(technique.name), technique.paper, code(technique.library_hash)],
                                                 ["shaders", broken(technique.name), "", code(technique.shader_hash)]])]),
      data.skipped.length > 0 && longList("Technique libraries that were skipped", data.skipped.map(one => one.library + ": " + one.reason)),
      data.command && [h("p", null, "This page was made by"), h("pre", null, data.command)]);
  }

  const left = data.scenes.reduce((sum, scene) => sum + scene.left_out_points.length, 0);
  const outOfTime = !data.complete ? `; STILL BEING MEASURED: ${plural(left, "point")} to come, reload for more`
    : left === 0 ? "" : `; no time for ${plural(left, "point")} in ${data.budget_s} s`;
  const voxels = data.voxels && !images.brief, stress = data.stress && !images.brief;
  show(
    h("header", { class: "bar" }, h("h1", null, "Lumivox report"),
      h("nav", { "aria-label": "parts of the report" }, data.scenes.map((scene, index) => link("scene-" + index, sceneTitle(scene))),
        data.scenes.some(scene => scene.points.length > 0) && link("summary", "All points"), voxels && link("voxels", "Voxels"), stress && link("stress", "Where it breaks"),
        link("device", "Device")),
      h("p", { class: "soft" }, data.device.renderer + ", " + data.date + outOfTime
        + (data.look ? "; A LOOK (--quick): a frame, a seed and four positions in the pixel for each point, so that no difference is decided" : ""))),
    h("main", null, data.scenes.map(sceneParts),
      h("section", { class: "rest", "aria-label": "all scenes" }, data.scenes.some(scene => scene.points.length > 0) && summary(),
        voxels && section("voxels", "Voxels", voxelSection(data.voxels, data.voxel_scaling)),
        stress && section("stress", "Where each technique breaks", stressSection(data.stress, "")), provenance()),
      h("p", { class: "caption" }, "The same numbers are in the .csv and .json files beside this page.",
        images.brief && " This is the brief page: the first screen of each scene alone.")));
})();
