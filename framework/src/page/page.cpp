// The one self-contained page: tables made here, charts drawn by the inlined library from the inlined
// records.
#include "lumivox/page/page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "lumivox/analysis/slopes.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/results/json.h"
#include "page/comparison_page.h"
#include "page/data.h"
#include "page/needs_page.h"
#include "page/noise_page.h"
#include "page/page_assets.h"
#include "page/page_parts.h"
#include "page/picture_page.h"
#include "page/stress_page.h"
#include "page/time_page.h"
#include "page/voxel_page.h"

namespace lumivox::page {
namespace {

const char* rowKind(const PointRecord& record) {
  return record.isDefault ? "default" : "";
}

std::string healthText(const PointRecord& record) {
  if (!record.point.failure.empty()) return "<span class=\"bad\">failed</span>";
  if (record.point.healthFindings.empty()) return "<span class=\"good\">good</span>";
  return fmt::format("<span class=\"bad\">{} finding{}</span>", record.point.healthFindings.size(),
                     record.point.healthFindings.size() == 1 ? "" : "s");
}

std::string summaryTable(const AnalysedReport& data) {
  Table table({{"Scene"},
               {"Pipeline"},
               {"Parameters", "wide"},
               {"Frame, ms", "number"},
               {"RMSE, whole picture", "number"},
               {"FLIP", "number"},
               {"Mean ratio", "number"},
               {"Saved", "number"},
               {"Front"},
               {"Health"}});
  for (const AnalysedScene& scene : data.analysed) {
    // Points on the front of the whole picture against full transport.
    std::vector<bool> front(scene.points.size(), false);
    if (const PipelineComparison* comparison = comparisonOf(scene, "final", false, "rmse"))
      for (const ComparedPoint& point : comparison->points) front[point.source] = !point.beatenBy;
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      const PointRecord& record = scene.points[i];
      const ComponentError* error = componentErrorOf(record.point, "final", false);
      std::string saved = "-";
      for (const PruningRecord& pruning : scene.pruning)
        if (record.isDefault && pruning.pipeline == record.point.pipeline)
          saved = percent(pruning.savedShare()) + "; " + percent(pruning.savedShareNext());
      table.row(
          {escaped(scene.name.empty() ? scene.file : scene.name), escaped(shortName(record.point.pipeline)),
           escaped(parametersText(record.point.parameters)), withQuartiles(record.point.frameMs),
           error ? withUncertainty(error->error.rmse) : "-", error ? number(error->error.flip) : "-",
           error ? withUncertainty(error->error.meanRatio) : "-", saved, front[i] ? "on the front" : "",
           healthText(record)},
          rowKind(record));
    }
  }
  return table.html();
}

std::string errorTable(const AnalysedScene& scene) {
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
      const bool oneTruth = error.bias && componentErrorOf(record.point, error.component, false) ==
                                              componentErrorOf(record.point, error.component, true);
      table.row(
          {escaped(shortName(record.point.pipeline)), escaped(parametersText(record.point.parameters)),
           escaped(error.output == kWholePicture ? "whole picture" : error.output), escaped(error.truth),
           oneTruth     ? "error"
           : error.bias ? "bias"
                        : "misses",
           withUncertainty(error.error.rmse), number(error.ratioToNothing()),
           withUncertainty(error.error.meanRatio), withUncertainty(error.error.bias),
           withUncertainty(error.error.relativeMse),
           withUncertainty({error.error.percentile95, error.error.percentile95Uncertainty}),
           withUncertainty({error.error.ssim, error.error.ssimUncertainty}),
           withUncertainty({error.error.flip, error.error.flipUncertainty}),
           withUncertainty({error.error.flipLdr, error.error.flipLdrUncertainty}),
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

std::string healthSection(const AnalysedScene& scene) {
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
std::string noteSection(const AnalysedScene& scene) {
  std::string items;
  for (const PointRecord& record : scene.points) {
    if (!record.isDefault) continue;
    for (const std::string& note : record.point.notes)
      items += "<li>" + escaped(shortName(record.point.pipeline) + ", " + note) + "</li>\n";
  }
  return items.empty() ? items : "<p>What passes tell of themselves:</p>\n<ul>\n" + items + "</ul>\n";
}

std::string truthText(const AnalysedScene& scene) {
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

std::string commandsSection(const AnalysedScene& scene) {
  std::string html = "<h3>Commands that repeat the points</h3>\n";
  for (const PointRecord& record : scene.points) html += "<pre>" + escaped(record.point.command) + "</pre>\n";
  return html;
}

std::string provenance(const AnalysedReport& data) {
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
  html += "</dl>\n" + ceilingSection(data.ceilings);
  Table table({{"Kind"}, {"Name"}, {"File"}, {"Hash"}});
  for (const AnalysedScene& scene : data.analysed)
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
  if (!data.commandLine.empty())
    html += "<p>This page was made by</p>\n<pre>" + escaped(data.commandLine) + "</pre>\n";
  return html;
}

std::string slopeSection(const AnalysedScene& scene) {
  const std::vector<SweepSlope> slopes = slopesOf(pointsOf(scene));
  if (slopes.empty()) return {};
  Table table({{"Pipeline"},
               {"Parameter"},
               {"Others"},
               {"Output"},
               {"Quantity"},
               {"Slope", "number"},
               {"Plateau", "number"},
               {"Slope above it", "number"},
               {"Values", "number"}});
  for (const SweepSlope& slope : slopes)
    table.row({escaped(shortName(slope.pipeline)),
               escaped(fmt::format("{} {:.4g} .. {:.4g}", slope.parameter, slope.low, slope.high)),
               escaped(slope.others),
               slope.output.empty()            ? "whole frame"
               : slope.output == kWholePicture ? "whole picture"
                                               : escaped(slope.output),
               slope.quantity, withUncertainty(slope.law.slope),
               slope.law.hasPlateau()                ? withUncertainty(slope.law.plateau)
               : std::isnan(slope.law.plateau.value) ? "-"
                                                     : "none",
               slope.law.hasPlateau() ? number(slope.law.slopeAbove) : "-",
               fmt::format("{}", slope.law.points)});
  return "<h3>Convergence</h3>\n<p class=\"caption\">Over each parameter that takes three values or more, the "
         "others fixed: the slope of log error, or log time, against the log of the parameter, by least "
         "squares. An error that falls in proportion to the voxel's size has the slope -1 over the resolution, "
         "noise -0.5 over the number of samples. Errors are RMSE without the truth's noise. The plateau, from "
         "four values on, is what stays however large the parameter becomes (of times: however small), as far "
         "as the fit of plateau plus power can tell; &ldquo;none&rdquo;: not above twice its uncertainty.</p>\n" +
         table.html();
}

std::string sceneSection(std::size_t index, const AnalysedScene& scene) {
  std::string html = fmt::format("<h2 id=\"scene-{}\">{}</h2>\n", index,
                                 escaped(scene.name.empty() ? scene.file : scene.name));
  html += truthText(scene);
  html += comparisonSection(index, scene);
  html += pictureSection(index, scene);
  html += errorTable(scene);
  html += noiseSection(scene) + slopeSection(scene);
  html += timeSection(index, scene);
  html += neededSection(scene);
  html += healthSection(scene);
  html += noteSection(scene);
  html += commandsSection(scene);
  return html;
}

}  // namespace

std::string toHtml(const AnalysedReport& data, const std::string& chartLibrary) {
  std::string scenes, links;
  for (std::size_t i = 0; i < data.analysed.size(); ++i) {
    scenes += sceneSection(i, data.analysed[i]);
    links +=
        fmt::format("<a href=\"#scene-{}\">{}</a>", i,
                    escaped(data.analysed[i].name.empty() ? data.analysed[i].file : data.analysed[i].name));
  }
  std::string html =
      "<header>\n<h1>Lumivox report</h1>\n<p class=\"soft\">How wrong, how fast, and what was left out. "
      "Measured on " +
      escaped(data.device.renderer) + ", " + escaped(data.date) +
      ". The same numbers stand in the .csv and .json files beside this page.</p>\n" +
      "<nav><a href=\"#summary\">Summary</a><a href=\"#needed\">What was needed</a>" + links +
      (data.voxels.empty() ? "" : "<a href=\"#voxels\">Voxels</a>") +
      (data.stress.empty() ? "" : "<a href=\"#stress\">Where it breaks</a>") +
      "<a href=\"#device\">Device and contents</a></nav>\n</header>\n<main>\n";
  html +=
      "<h2 id=\"summary\">Summary</h2>\n<p class=\"caption\">RMSE, FLIP and mean ratio of the whole picture "
      "against full transport. "
      "&ldquo;Saved&rdquo;: share of the time of a first frame, and of one that follows another, that "
      "leaving "
      "out unneeded work saves. Bold rows are the default parameters.</p>\n" +
      summaryTable(data);
  html += neededMatrix(data);
  html += scenes;
  html += voxelSection(data.voxels);
  html += stressSection(data.stress, "");
  html += provenance(data) + "</main>\n";
  html += dataBlock("data", textOf(toJson(data), -1));
  std::string scripts = std::string(kPageScript) + kComparisonScript + kPictureScript;
  if (!data.voxels.empty()) scripts += kVoxelScript;
  const std::string styles = truthStyles(data) + (data.stress.empty() ? "" : kStressStyle);
  return wholePage("Lumivox report", styles, html, chartLibrary, scripts);
}

}  // namespace lumivox::page

namespace lumivox {

ReportFiles reportFiles(const std::filesystem::path& page) {
  const ReportFiles files{page, std::filesystem::path(page).replace_extension(".csv"),
                          std::filesystem::path(page).replace_extension(".json")};
  if (files.page == files.csv || files.page == files.json)
    throw Error(page.string() + ": the page cannot have the extension of the files beside it; use .html");
  for (const auto& file : {files.page, files.csv, files.json}) requireWritable(file);
  page::chartLibrary();
  return files;
}

void writeReport(const ReportFiles& files, const ReportRecord& record) {
  const page::AnalysedReport data = page::analysed(record);
  const std::string library = page::chartLibrary();
  writeFileAtomically(files.json, textOf(page::toJson(data), 1) + "\n");
  writeFileAtomically(files.csv, page::toCsv(data));
  writeFileAtomically(files.page, page::toHtml(data, library));
}

}  // namespace lumivox
