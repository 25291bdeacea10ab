// The one self-contained page: tables made here, charts drawn by the inlined library from the inlined
// records.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "lumivox/base/file.h"
#include "report/data.h"
#include "report/page_assets.h"
#include "report/page_parts.h"
#include "report/voxel_page.h"

namespace lumivox::report {
namespace {

std::string parametersText(const ParameterValues& values) {
  std::string text;
  for (const auto& [name, value] : values) text += (text.empty() ? "" : ", ") + name + " " + value.text();
  return text.empty() ? "default" : text;
}

std::string componentTitle(const std::string& component) {
  if (component == "final") return "Whole picture";
  std::string title = component;
  std::replace(title.begin(), title.end(), '_', ' ');
  title.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(title.front())));
  return title;
}

const char* rowKind(const PointRecord& record) {
  return record.isDefault ? "default" : "";
}

std::string healthText(const PointRecord& record) {
  if (!record.point.failure.empty()) return "<span class=\"bad\">failed</span>";
  if (record.point.healthFindings.empty()) return "<span class=\"good\">good</span>";
  return fmt::format("<span class=\"bad\">{} finding{}</span>", record.point.healthFindings.size(),
                     record.point.healthFindings.size() == 1 ? "" : "s");
}

std::string summaryTable(const ReportData& data) {
  Table table({{"Scene"},
               {"Pipeline"},
               {"Parameters"},
               {"Frame, ms", "number"},
               {"RMSE, whole picture", "number"},
               {"FLIP", "number"},
               {"Mean ratio", "number"},
               {"Saved", "number"},
               {"Front"},
               {"Health"}});
  for (const SceneRecord& scene : data.scenes) {
    const std::vector<bool> front = frontOf(scene.points, "final", false);
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      const PointRecord& record = scene.points[i];
      const ComponentError* error = errorOf(record.point, "final", false);
      std::string saved = "-";
      for (const PruningRecord& pruning : scene.pruning)
        if (record.isDefault && pruning.pipeline == record.point.pipeline)
          saved = percent(pruning.savedShare()) + "; " + percent(pruning.savedShareNext());
      table.row(
          {escaped(scene.name.empty() ? scene.file : scene.name), escaped(shortName(record.point.pipeline)),
           escaped(parametersText(record.point.parameters)), withQuartiles(record.point.frameMs),
           error ? withUncertainty(error->rmse()) : "-", error ? number(error->error.flip) : "-",
           error ? withUncertainty(error->error.meanRatio) : "-", saved, front[i] ? "on the front" : "",
           healthText(record)},
          rowKind(record));
    }
  }
  return table.html();
}

std::string errorCharts(std::size_t sceneIndex, const std::vector<std::string>& components,
                        const SceneRecord& scene) {
  std::string html =
      "<h3>Error against run time</h3>\n<p class=\"caption\">Filled points and full lines: against the truth "
      "of the technique's own "
      "model (one bounce where it computes one), which is its bias. Hollow points and broken lines: against "
      "full transport, which is what a "
      "viewer misses. Bars: quartiles of the frame time; one standard uncertainty of the error, of the "
      "truth's noise and the spread over "
      "seeds together. The dashed grey line is the error of leaving the component out. Down and to the left "
      "is better.</p>\n"
      "<p><label>Measure: <select class=\"metric\" data-scene=\"" +
      std::to_string(sceneIndex) +
      "\"><option value=\"rmse\">RMSE</option><option value=\"relative_mse\">relative MSE</option>"
      "<option value=\"percentile_95\">95th percentile</option><option value=\"flip_hdr\">FLIP</option>"
      "</select></label> <span class=\"caption\">A few very bright pixels, such as the edges of a lamp, can "
      "rule "
      "the RMSE; the 95th percentile and FLIP are less moved by them.</span></p>\n"
      "<div class=\"charts\">\n";
  for (const std::string& component : components) {
    const bool drawable =
        std::any_of(scene.points.begin(), scene.points.end(), [&](const PointRecord& record) {
          const ComponentError* bias = errorOf(record.point, component, true);
          const ComponentError* miss = errorOf(record.point, component, false);
          return record.point.failure.empty() && ((bias != nullptr && bias->rmse().value > 0.0) ||
                                                  (miss != nullptr && miss->rmse().value > 0.0));
        });
    html += "<figure><h4>" + escaped(componentTitle(component)) + "</h4>";
    if (drawable)
      html += fmt::format(
          "<div class=\"chart\"><canvas data-chart=\"error\" data-scene=\"{}\" "
          "data-component=\"{}\"></canvas></div>",
          sceneIndex, escaped(component));
    else
      html +=
          "<p class=\"caption\">Nothing to draw: no error, since neither the truth nor any picture has such "
          "light.</p>";
    html += "</figure>\n";
  }
  return html + "</div>\n";
}

std::string frontText(const SceneRecord& scene, const std::vector<std::string>& components) {
  std::string html =
      "<p class=\"caption\">Not beaten by any other point in both time and error (against full "
      "transport):</p>\n<ul>\n";
  for (const std::string& component : components) {
    const std::vector<bool> front = frontOf(scene.points, component, false);
    std::string names;
    for (std::size_t i = 0; i < front.size(); ++i)
      if (front[i])
        names += (names.empty() ? "" : "; ") + escaped(shortName(scene.points[i].point.pipeline)) + " (" +
                 escaped(parametersText(scene.points[i].point.parameters)) + ")";
    html += "<li><b>" + escaped(componentTitle(component)) + ":</b> " + (names.empty() ? "none" : names) +
            "</li>\n";
  }
  return html + "</ul>\n";
}

std::string errorTable(const SceneRecord& scene) {
  Table table({{"Pipeline"},
               {"Parameters"},
               {"Output"},
               {"Truth"},
               {"Says"},
               {"RMSE", "number"},
               {"of left out", "number"},
               {"Mean ratio", "number"},
               {"Mean difference", "number"},
               {"Relative MSE", "number"},
               {"95th percentile", "number"},
               {"SSIM", "number"},
               {"FLIP HDR", "number"},
               {"FLIP LDR", "number"},
               {"Truth's noise", "number"},
               {"Picture's noise", "number"},
               {"NaN, Inf", "number"}});
  for (const PointRecord& record : scene.points)
    for (const ComponentError& error : record.point.errors) {
      const std::uint64_t bad = error.error.nonFinitePicture;
      const bool oneTruth = error.bias && errorOf(record.point, error.component, false) ==
                                              errorOf(record.point, error.component, true);
      table.row(
          {escaped(shortName(record.point.pipeline)), escaped(parametersText(record.point.parameters)),
           escaped(error.output == kWholePicture ? "whole picture" : error.output), escaped(error.truth),
           oneTruth     ? "error"
           : error.bias ? "bias"
                        : "misses",
           withUncertainty(error.rmse()), number(error.ratioToNothing()),
           withUncertainty(error.error.meanRatio), withUncertainty(error.error.bias),
           withUncertainty(error.error.relativeMse), number(error.error.percentile95),
           number(error.error.ssim), number(error.error.flip), number(error.error.flipLdr),
           number(error.error.noiseFloor),
           error.seeds < 2       ? "one seed"
           : error.deterministic ? "none"
                                 : number(error.noiseRmse),
           bad == 0 ? "0" : fmt::format("<span class=\"bad\">{}</span>", bad)},
          rowKind(record));
    }
  return "<h3>Error numbers</h3>\n<p class=\"caption\">RMSE, mean difference and percentile in W/(sr "
         "m&sup2;). &ldquo;Of left out&rdquo; is "
         "the RMSE divided by that of a black picture: below 1 the component is better than none. Mean ratio "
         "is the picture's energy over "
         "the truth's. Pixels that are NaN or infinite are counted and left out of the numbers. Numbers "
         "after &plusmn; are one standard "
         "uncertainty. Bold rows are the default parameters.</p>\n" +
         table.html();
}

std::string timeSection(std::size_t sceneIndex, const SceneRecord& scene) {
  const std::size_t bars = scene.points.size();
  std::string html =
      "<h3>Time and memory per pass</h3>\n<p class=\"caption\">Medians over repeats of frames in which every "
      "kept pass "
      "runs; quartiles in brackets. Measured apart from the pictures above.</p>\n<div class=\"charts\">\n";
  for (const char* chart : {"time", "bytes"})
    html += fmt::format(
        "<figure><div class=\"chart\" style=\"height:{}px\"><canvas data-chart=\"{}\" "
        "data-scene=\"{}\"></canvas></div></figure>\n",
        140 + 48 * bars, chart, sceneIndex);
  html += "</div>\n";

  std::vector<std::string> pipelines;
  for (const PointRecord& record : scene.points)
    if (std::find(pipelines.begin(), pipelines.end(), record.point.pipeline) == pipelines.end())
      pipelines.push_back(record.point.pipeline);
  for (const std::string& pipeline : pipelines) {
    std::vector<const PointRecord*> points;
    std::vector<std::string> passes;
    for (const PointRecord& record : scene.points) {
      if (record.point.pipeline != pipeline || !record.point.failure.empty()) continue;
      points.push_back(&record);
      for (const std::string& pass : record.point.passOrder)
        if (std::find(passes.begin(), passes.end(), pass) == passes.end()) passes.push_back(pass);
    }
    if (points.empty()) continue;
    std::vector<Table::Column> columns{{"Pass"}};
    for (const PointRecord* record : points)
      columns.push_back({escaped(parametersText(record->point.parameters)) + ": ms", "number"});
    for (const PointRecord* record : points)
      columns.push_back({escaped(parametersText(record->point.parameters)) + ": memory", "number"});
    Table table(columns);
    const auto row = [&](const std::string& title, const auto& time, const auto& memory,
                         const char* kind = "") {
      std::vector<std::string> cells{title};
      for (const PointRecord* record : points) cells.push_back(time(record->point));
      for (const PointRecord* record : points) cells.push_back(memory(record->point));
      table.row(cells, kind);
    };
    const auto nothing = [](const ReportPoint&) { return std::string(); };
    for (const std::string& pass : passes)
      row(
          escaped(pass),
          [&](const ReportPoint& point) {
            const auto found = point.passDeviceMs.find(pass);
            return found == point.passDeviceMs.end() ? std::string("-") : withQuartiles(found->second);
          },
          [&](const ReportPoint& point) {
            const auto found = point.passBytes.find(pass);
            return found == point.passBytes.end() ? std::string("-") : formatBytes(found->second);
          });
    row(
        "whole frame; most memory at once",
        [](const ReportPoint& point) { return withQuartiles(point.frameMs); },
        [](const ReportPoint& point) { return formatBytes(point.peakBytes); }, "total");
    row(
        "between passes (the framework)",
        [](const ReportPoint& point) { return percent(point.frameworkShare); }, nothing);
    row(
        "next frame, only what changed",
        [](const ReportPoint& point) { return withQuartiles(point.nextFrameMs); }, nothing);
    html += "<h4>" + escaped(shortName(pipeline)) + "</h4>\n" + table.html();
  }
  return html;
}

std::string image(const std::string& png, const std::string& text) {
  return fmt::format("<img alt=\"{}\" src=\"data:image/png;base64,{}\">", escaped(text), base64(png));
}

std::string truthFigure(std::size_t sceneIndex, const SceneRecord& scene, const std::string& layer,
                        const std::string& caption) {
  const auto known = std::any_of(scene.truths.begin(), scene.truths.end(),
                                 [&](const TruthRecord& truth) { return truth.layer == layer; });
  if (!known) return {};
  return fmt::format(
      "<figure><div class=\"truth truth-{}-{}\" style=\"aspect-ratio:{}/{}\" role=\"img\" "
      "aria-label=\"truth: {}\"></div>"
      "<figcaption>{}</figcaption></figure>\n",
      sceneIndex, escaped(layer), scene.width, scene.height, escaped(layer), caption);
}

/// Every truth picture once, as a style, however often it is shown.
std::string truthStyles(const ReportData& data) {
  std::string css;
  for (std::size_t i = 0; i < data.scenes.size(); ++i)
    for (const TruthRecord& truth : data.scenes[i].truths)
      css += fmt::format(".truth-{}-{} {{ background-image: url(data:image/png;base64,{}); }}\n", i,
                         truth.layer, base64(truth.picture));
  return css;
}

std::string pictureStrip(std::size_t sceneIndex, const SceneRecord& scene, const OutputPictures& pictures,
                         const std::string& title) {
  std::string html = "<div class=\"strip\">\n<figure>" + image(pictures.picture, title) + "<figcaption>" +
                     escaped(title) + "</figcaption></figure>\n";
  for (const OutputPictures::Against& against : pictures.against) {
    html += truthFigure(sceneIndex, scene, against.truth, "truth: " + escaped(against.truth));
    html += "<figure>" + image(against.flipMap, "FLIP map against " + against.truth) +
            fmt::format("<figcaption>FLIP against {}: mean {:.3f}</figcaption></figure>\n",
                        escaped(against.truth), against.flip);
  }
  return html + "</div>\n";
}

std::string pictureSection(std::size_t sceneIndex, const SceneRecord& scene,
                           const std::vector<std::string>& components) {
  std::string html =
      "<h3>Pictures, truth and FLIP maps</h3>\n<p class=\"caption\">All pictures of one component are shown "
      "at one exposure, which puts the "
      "99th percentile of its full truth at 0.8 before the sRGB curve. A FLIP map is dark where a viewer "
      "sees no difference and bright where "
      "the difference is plain. NaN pixels are magenta. Pictures are means over positions in the pixel, as the truth is.</p>\n";
  // The whole picture is what a reader looks for first.
  std::vector<std::string> order(components);
  std::stable_partition(order.begin(), order.end(),
                        [](const std::string& component) { return component == "final"; });
  for (const std::string& component : order) {
    double exposure = 1.0;
    std::string strips, more;
    for (const PointRecord& record : scene.points)
      for (const OutputPictures& pictures : record.pictures) {
        if (pictures.component != component || (component == "final" && pictures.output != kWholePicture))
          continue;
        for (const TruthRecord& truth : scene.truths)
          if (!pictures.against.empty() && truth.layer == pictures.against.back().truth)
            exposure = truth.exposure;
        const std::string strip =
            pictureStrip(sceneIndex, scene, pictures,
                         shortName(record.point.pipeline) + ", " + parametersText(record.point.parameters));
        (record.isDefault ? strips : more) += strip;
      }
    html += fmt::format("<h4>{} <span class=\"soft\">(exposure {:.3g})</span></h4>\n",
                        escaped(componentTitle(component)), exposure) +
            strips;
    if (!more.empty())
      html += "<details><summary>Other points of the sweeps</summary>\n" + more + "</details>\n";
  }
  return html;
}

std::string leftOutSection(const SceneRecord& scene) {
  std::string html =
      "<h3>What was left out, and what that saved</h3>\n<p class=\"caption\">The pipeline as it runs and the "
      "same with everything kept, timed "
      "alternately at the default parameters. Leaving out may change the cost, never the picture.</p>\n";
  for (const PruningRecord& record : scene.pruning) {
    const Explanation& explanation = record.explanation;
    html += "<h4>" + escaped(shortName(record.pipeline)) + "</h4>\n";
    html += fmt::format(
        "<p>{} ms instead of {} ms: <b>{}</b> of the time of a first frame saved; {} ms instead of {} ms: "
        "<b>{}</b> "
        "of that of a frame that follows another while the camera moves. {} of {} passes kept; shader "
        "variants: {} possible, {} "
        "compiled, {} needed. Memory taken by the passes: {} instead of {}. Same picture, bit for bit: "
        "{}.</p>\n",
        withQuartiles(record.prunedMs), withQuartiles(record.unprunedMs), percent(record.savedShare()),
        withQuartiles(record.nextPrunedMs), withQuartiles(record.nextUnprunedMs),
        percent(record.savedShareNext()), explanation.passesKept, explanation.passesTotal,
        explanation.variantsPossible, explanation.variantsCompiled, explanation.variantsNeeded,
        formatBytes(record.prunedBytes), formatBytes(record.unprunedBytes),
        record.samePicture ? "<span class=\"good\">yes</span>" : "<span class=\"bad\">NO</span>");
    if (!explanation.leftOut.empty()) {
      Table table(
          {{"Level"}, {"Left out"}, {"Why", "wide"}, {"Saved memory", "number"}, {"Saved ms", "number"}});
      for (const LeftOut& one : explanation.leftOut)
        table.row({name(one.level), escaped(one.what), escaped(one.why),
                   one.savedBytes == 0 ? "" : formatBytes(one.savedBytes),
                   one.savedMs == 0.0 ? "" : number(one.savedMs)});
      html += table.html();
    }
    Table passes(
        {{"Pass"}, {"as it runs, ms", "number"}, {"everything kept, ms", "number"}, {"saved, ms", "number"}});
    for (const std::string& pass : record.passOrder) {
      const auto pruned = record.prunedPassMs.find(pass), unpruned = record.unprunedPassMs.find(pass);
      const double before = unpruned == record.unprunedPassMs.end() ? 0.0 : unpruned->second.median;
      const double after = pruned == record.prunedPassMs.end() ? 0.0 : pruned->second.median;
      passes.row({escaped(pass),
                  pruned == record.prunedPassMs.end() ? "left out" : withQuartiles(pruned->second),
                  unpruned == record.unprunedPassMs.end() ? "-" : withQuartiles(unpruned->second),
                  number(before - after)});
    }
    html += "<details><summary>Pass by pass</summary>\n" + passes.html() + "</details>\n";
  }
  if (!scene.unsuited.empty()) {
    html += "<p>Committed pipelines that do not suit this scene:</p>\n<ul>\n";
    for (const auto& [pipeline, why] : scene.unsuited)
      html += "<li>" + escaped(shortName(pipeline)) + ": " + escaped(why) + "</li>\n";
    html += "</ul>\n";
  }
  return html;
}

std::string healthSection(const SceneRecord& scene) {
  std::string items;
  for (const PointRecord& record : scene.points) {
    const std::string place =
        escaped(shortName(record.point.pipeline) + " (" + parametersText(record.point.parameters) + "): ");
    if (!record.point.failure.empty())
      items += "<li class=\"bad\">" + place + escaped(record.point.failure) + "</li>\n";
    for (const std::string& finding : record.point.healthFindings)
      items += "<li>" + place + escaped(finding) + "</li>\n";
  }
  return "<h3>Health</h3>\n" +
         (items.empty()
              ? std::string("<p>Every output of every pass was scanned for NaN, Inf and negative values: "
                            "none was found.</p>\n")
              : "<ul>\n" + items + "</ul>\n");
}

/// What passes measured about themselves, at the default points.
std::string noteSection(const SceneRecord& scene) {
  std::string items;
  for (const PointRecord& record : scene.points) {
    if (!record.isDefault) continue;
    for (const std::string& note : record.point.notes)
      items += "<li>" + escaped(shortName(record.point.pipeline) + ", " + note) + "</li>\n";
  }
  return items.empty() ? items : "<p>What passes tell of themselves:</p>\n<ul>\n" + items + "</ul>\n";
}

std::string truthText(const SceneRecord& scene) {
  std::string html = fmt::format(
      "<p>{} triangles, camera &ldquo;{}&rdquo;, {} &times; {} pixels, time {} s. Truth: path tracing with "
      "{} samples per "
      "pixel{}. Scene hash <code>{}</code>.</p>\n",
      scene.triangles, escaped(scene.camera), scene.width, scene.height, scene.time, scene.truthSamples,
      scene.truthSeconds >= 0.1 ? fmt::format(" ({:.3g} s)", scene.truthSeconds) : "", scene.hash);
  Table table({{"Truth layer"},
               {"Noise (RMS)", "number"},
               {"Mean", "number"},
               {"Noise / mean", "number"},
               {"Largest", "number"},
               {"Shown at exposure", "number"}});
  for (const TruthRecord& truth : scene.truths)
    table.row({escaped(truth.layer), number(truth.noise), number(truth.mean),
               truth.mean > 0.0 ? percent(truth.noise / truth.mean) : "-", number(truth.largest),
               number(truth.exposure)});
  html += "<details><summary>The truth's own noise</summary>\n" + table.html();
  html += "<dl>\n";
  for (const auto& [name, value] : scene.truthAttributes)
    html += "<dt>" + escaped(name) + "</dt><dd>" + escaped(value) + "</dd>\n";
  return html + "</dl></details>\n";
}

std::string commandsSection(const SceneRecord& scene) {
  std::string html = "<h3>Commands that repeat the points</h3>\n";
  for (const PointRecord& record : scene.points) html += "<pre>" + escaped(record.point.command) + "</pre>\n";
  return html;
}

std::string provenance(const ReportData& data) {
  const gpu::DeviceInfo& device = data.device;
  std::string html = "<h2 id=\"device\">Device, driver and contents</h2>\n<dl>\n";
  const auto item = [&](const char* title, const std::string& value) {
    html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", title, escaped(value));
  };
  item("Device", device.renderer + (device.software ? " (a software rasteriser)" : ""));
  item("Vendor", device.vendor);
  item("Driver", device.version);
  item("Platform", device.platform);
  item("Host", data.host);
  item("Shaders", data.shaderInput);
  item("Timer",
       std::string(device.timerQueriesTrusted ? "timer queries; " : "fenced clock; ") + device.timerNote);
  item("Date", data.date);
  html += "</dl>\n";
  Table table({{"Kind"}, {"Name"}, {"File"}, {"Hash"}});
  for (const SceneRecord& scene : data.scenes)
    table.row({"scene", escaped(scene.name), escaped(scene.file), "<code>" + scene.hash + "</code>"});
  for (const PipelineRecord& pipeline : data.pipelines)
    table.row(
        {"pipeline", escaped(pipeline.name), escaped(pipeline.file), "<code>" + pipeline.hash + "</code>"});
  for (const TechniqueRecord& technique : data.techniques) {
    table.row({"technique", escaped(technique.name), escaped(technique.paper),
               "<code>" + technique.libraryHash + "</code>"});
    table.row({"shaders", escaped(technique.name), "", "<code>" + technique.shaderHash + "</code>"});
  }
  html += table.html();
  if (!data.skipped.empty()) {
    html += "<p>Technique libraries that were skipped:</p>\n<ul>\n";
    for (const SkippedTechnique& skipped : data.skipped)
      html += "<li>" + escaped(skipped.library.string()) + ": " + escaped(skipped.reason) + "</li>\n";
    html += "</ul>\n";
  }
  if (!data.options.commandLine.empty())
    html += "<p>This page was made by</p>\n<pre>" + escaped(data.options.commandLine) + "</pre>\n";
  return html;
}

std::string sceneSection(std::size_t index, const SceneRecord& scene) {
  const std::vector<std::string> components = componentsOf(scene);
  std::string html = fmt::format("<h2 id=\"scene-{}\">{}</h2>\n", index,
                                 escaped(scene.name.empty() ? scene.file : scene.name));
  html += truthText(scene);
  html += errorCharts(index, components, scene) + frontText(scene, components);
  html += pictureSection(index, scene, components);
  html += errorTable(scene);
  html += timeSection(index, scene);
  html += leftOutSection(scene);
  html += healthSection(scene);
  html += noteSection(scene);
  html += commandsSection(scene);
  return html;
}

}  // namespace

std::string toHtml(const ReportData& data, const std::string& chartLibrary) {
  std::string scenes, links;
  for (std::size_t i = 0; i < data.scenes.size(); ++i) {
    scenes += sceneSection(i, data.scenes[i]);
    links += fmt::format("<a href=\"#scene-{}\">{}</a>", i,
                         escaped(data.scenes[i].name.empty() ? data.scenes[i].file : data.scenes[i].name));
  }
  std::string html =
      "<header>\n<h1>Lumivox report</h1>\n<p class=\"soft\">How wrong, how fast, and what was left out. "
      "Measured on " +
      escaped(data.device.renderer) + ", " + escaped(data.date) +
      ". The same numbers stand in the .csv and .json files beside this page.</p>\n" +
      "<nav><a href=\"#summary\">Summary</a>" + links +
      (data.voxels.empty() ? "" : "<a href=\"#voxels\">Voxels</a>") +
      "<a href=\"#device\">Device and contents</a></nav>\n</header>\n<main>\n";
  html +=
      "<h2 id=\"summary\">Summary</h2>\n<p class=\"caption\">RMSE, FLIP and mean ratio of the whole picture "
      "against full transport. "
      "&ldquo;Saved&rdquo;: share of the time of a first frame, and of one that follows another, that "
      "leaving "
      "out unneeded work saves. Bold rows are the default parameters.</p>\n" +
      summaryTable(data);
  html += scenes;
  html += voxelSection(data.voxels);
  html += provenance(data) + "</main>\n";
  html += dataBlock("data", toJson(data).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  std::string scripts = kPageScript;
  if (!data.voxels.empty()) scripts += kVoxelScript;
  return wholePage("Lumivox report", truthStyles(data), html, chartLibrary, scripts);
}

}  // namespace lumivox::report
