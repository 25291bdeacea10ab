#include "page/comparison_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "page/page_parts.h"

namespace lumivox::page {
namespace {

struct Choice {
  const char *value, *title;
};
/// One for each of kPageMetrics.
constexpr Choice kMetricTitles[] = {{"rmse", "RMSE"},
                                    {"relative_mse", "relative MSE"},
                                    {"percentile95", "95th percentile"},
                                    {"flip", "FLIP"}};
constexpr Choice kAgainst[] = {{"misses", "full transport: what a viewer misses"},
                               {"bias", "the technique's own model: its bias"}};

template <std::size_t count>
std::string chooser(const char* kind, std::size_t scene, const char* label, const Choice (&choices)[count]) {
  std::string html =
      fmt::format("<label>{}: <select data-choose=\"{}\" data-scene=\"{}\">", label, kind, scene);
  for (const Choice& choice : choices)
    html += fmt::format("<option value=\"{}\">{}</option>", choice.value, escaped(choice.title));
  return html + "</select></label> ";
}

/// The parameters in which the points of a pipeline differ: the others say nothing here.
std::string parametersOf(const PipelineComparison& comparison, const ComparedPoint& point) {
  ParameterValues differing;
  for (const auto& [name, value] : point.parameters) {
    const auto differs = [&, &name = name, &value = value](const ComparedPoint& other) {
      const auto found = other.parameters.find(name);
      return other.pipeline == point.pipeline &&
             (found == other.parameters.end() || !(found->second == value));
    };
    if (std::any_of(comparison.points.begin(), comparison.points.end(), differs)) differing[name] = value;
  }
  return escaped(parametersText(differing));
}

std::string pipelineOf(const PipelineComparison& comparison, const ComparedPoint& point) {
  return escaped(shortName(comparison.pipelines[point.pipeline].pipeline));
}

std::string pointName(const PipelineComparison& comparison, const ComparedPoint& point) {
  return pipelineOf(comparison, point) + " <span class=\"soft\">(" + parametersOf(comparison, point) +
         ")</span>";
}

/// From which budget on which pipeline has the least error.
std::string rangeTable(const PipelineComparison& comparison) {
  Table table({{"Budget, ms", "number"},
               {"Least error", "number"},
               {"Pipeline"},
               {"Parameters"},
               {"Not told apart from it", "wide"}});
  for (const BudgetRange& range : comparison.ranges) {
    const ComparedPoint& best = comparison.points[range.best.front()];
    std::string others;
    for (std::size_t i = 1; i < range.best.size(); ++i)
      others += (i == 1 ? "" : ", ") + pipelineOf(comparison, comparison.points[range.best[i]]);
    table.row({range.toMs ? formatMilliseconds(range.fromMs) + " &ndash; " + formatMilliseconds(*range.toMs)
                          : "from " + formatMilliseconds(range.fromMs) + " on",
               withUncertainty(best.tradeOff.error), "<b>" + pipelineOf(comparison, best) + "</b>",
               parametersOf(comparison, best), others});
  }
  return table.html();
}

/// Pipelines without a point on the front, and whose points beat theirs.
std::string beatenList(const PipelineComparison& comparison) {
  std::string list;
  for (std::size_t pipeline = 0; pipeline < comparison.pipelines.size(); ++pipeline) {
    if (comparison.hasFront(pipeline)) continue;
    std::set<std::size_t> by;
    for (const ComparedPoint& point : comparison.points)
      if (point.pipeline == pipeline && point.beatenBy)
        by.insert(comparison.points[*point.beatenBy].pipeline);
    list += "<li>" + escaped(shortName(comparison.pipelines[pipeline].pipeline)) + ", by ";
    for (auto it = by.begin(); it != by.end(); ++it)
      list += (it == by.begin() ? "" : ", ") + (*it == pipeline
                                                    ? std::string("itself at other parameters")
                                                    : escaped(shortName(comparison.pipelines[*it].pipeline)));
    list += "</li>\n";
  }
  return list.empty() ? "<p>Every pipeline is unbeaten at some budget.</p>\n"
                      : "<p>Beaten at every budget:</p>\n<ul>\n" + list + "</ul>\n";
}

std::string timeText(const Measured& timeMs) {
  return fmt::format("{} <span class=\"uncertainty\">&plusmn; {}</span>", formatMilliseconds(timeMs.value),
                     oneDigit(timeMs.uncertainty));
}

std::string cellText(const ComparedCell& cell, const char* notReached,
                     std::string (*measuredText)(const Measured&)) {
  const Interpolated& reached = cell.reached;
  switch (reached.reach) {
    case Reach::notMeasured:
      return "-";
    case Reach::notReached:
      return std::string("<span class=\"soft\">") + notReached + "</span>";
    default:
      break;
  }
  const std::string text = (reached.reach == Reach::atMost ? "&le; " : "") + measuredText(reached.value);
  return cell.best ? "<b>" + text + "</b>" : text;
}

std::string equalTable(const PipelineComparison& comparison, const std::vector<double>& limits,
                       const std::string& unit, const char* notReached,
                       std::string (*measuredText)(const Measured&),
                       std::vector<ComparedCell> ComparedPipeline::*cells) {
  std::vector<Table::Column> columns{{"Pipeline"}};
  for (const double limit : limits) columns.push_back({fmt::format("{:.4g}{}", limit, unit), "number"});
  Table table(columns);
  for (const ComparedPipeline& pipeline : comparison.pipelines) {
    std::vector<std::string> row{escaped(shortName(pipeline.pipeline))};
    for (const ComparedCell& cell : pipeline.*cells) row.push_back(cellText(cell, notReached, measuredText));
    table.row(row);
  }
  return table.html();
}

std::string pointTable(const PipelineComparison& comparison) {
  Table table({{"Pipeline"}, {"Parameters"}, {"Frame, ms", "number"}, {"Error", "number"}, {"Front"}});
  for (const ComparedPoint& point : comparison.points)
    table.row({pipelineOf(comparison, point), parametersOf(comparison, point), withQuartiles(point.frameMs),
               withUncertainty(point.tradeOff.error),
               point.beatenBy ? "beaten by " + pointName(comparison, comparison.points[*point.beatenBy])
                              : std::string("<span class=\"good\">on the front</span>")},
              point.beatenBy ? "" : "default");
  return table.html();
}

std::string comparisonTables(const PipelineComparison& comparison) {
  std::string html =
      "<h5>Least error within a budget</h5>\n" + rangeTable(comparison) + beatenList(comparison);
  if (!comparison.budgetsMs.empty())
    html += "<h5>Equal time: the error that each reaches</h5>\n" +
            equalTable(comparison, comparison.budgetsMs, " ms", "slower", withUncertainty,
                       &ComparedPipeline::atTime);
  if (comparison.errors.empty())
    html += "<p>All errors are the same within 0.5 %: there is nothing to interpolate between.</p>\n";
  else
    html +=
        "<h5>Equal error: the time that each needs, ms</h5>\n" +
        equalTable(comparison, comparison.errors, "", "not reached", timeText, &ComparedPipeline::atError);
  return html + "<h5>All points, by time</h5>\n" + pointTable(comparison);
}

/// Charts of the components that have errors, and a line on those that have none.
std::string charts(std::size_t sceneIndex, const AnalysedScene& scene,
                   const std::vector<std::string>& components) {
  std::string figures, nothing;
  for (const std::string& component : components) {
    const PipelineComparison* comparison = comparisonOf(scene, component, false, "rmse");
    if (comparison != nullptr && !comparison->front.empty())
      figures += fmt::format(
          "<figure><h4>{}</h4><div class=\"chart\"><canvas data-chart=\"error\" data-scene=\"{}\" "
          "data-component=\"{}\"></canvas></div></figure>\n",
          escaped(componentTitle(component)), sceneIndex, escaped(component));
    else
      nothing += (nothing.empty() ? "" : ", ") + escaped(componentTitle(component));
  }
  if (!nothing.empty())
    nothing = "<p class=\"caption\">Nothing to draw: " + nothing +
              " has no error, since neither the truth nor any picture has such light.</p>\n";
  return "<div class=\"charts\">\n" + figures + "</div>\n" + nothing;
}

std::string componentTables(std::size_t sceneIndex, const AnalysedScene& scene,
                            const std::string& component) {
  std::string html;
  for (const Choice& metric : kMetricTitles)
    for (const Choice& against : kAgainst) {
      const bool bias = std::string("bias") == against.value;
      const PipelineComparison* comparison = comparisonOf(scene, component, bias, metric.value);
      // Where one truth answers for both there is one comparison.
      if (comparison == nullptr || comparison->front.empty() || comparison->bias != bias) continue;
      // One is shown at a time.
      const bool shown = !bias && std::string("rmse") == metric.value;
      html += fmt::format(
          "<div data-tables=\"{}\" data-metric=\"{}\" data-against=\"{}\"{}>\n<p class=\"caption\">{} against "
          "the truth's layer <code>{}</code>.</p>\n",
          sceneIndex, metric.value, against.value, shown ? "" : " hidden", escaped(metric.title),
          escaped(comparison->truth));
      html += comparisonTables(*comparison) + "</div>\n";
    }
  if (html.empty()) return html;
  return fmt::format("<details{}><summary>{}: fronts, equal time, equal error</summary>\n",
                     component == "final" ? " open" : "", escaped(componentTitle(component))) +
         html + "</details>\n";
}

/// What the claims of a scene's fronts rest on.
std::string basisOf(const AnalysedScene& scene) {
  if (scene.comparisons.empty()) return {};
  const PipelineComparison& one = scene.comparisons.front();
  std::string text = fmt::format(" Times count as different beyond {:.1f} %", 100.0 * one.timeShare);
  text += one.controls == 0
              ? ", since no point was timed twice here."
              : fmt::format(
                    ": so far apart, at most, lay the times of {} points that were timed twice, "
                    "and at least 5 %.",
                    one.controls);
  std::size_t undecided = 0, points = 0;
  for (const PipelineComparison& comparison : scene.comparisons)
    if (comparison.undecided > undecided) {
      undecided = comparison.undecided;
      points = comparison.points.size();
    }
  if (undecided > 0)
    text += fmt::format(
        " Of {} of {} points there are fewer than {} timed frames or seeds: whether they are better "
        "or worse is undecided, and they neither beat nor are beaten.",
        undecided, points, kLeastRepeats);
  return text;
}

}  // namespace

std::string comparisonSection(std::size_t sceneIndex, const AnalysedScene& scene) {
  static_assert(std::size(kMetricTitles) == std::size(kPageMetrics));
  const std::vector<std::string> components = componentsOf(pointsOf(scene));
  const auto some = [&](auto condition) {
    return std::any_of(scene.comparisons.begin(), scene.comparisons.end(),
                       [&](const PipelineComparison& one) { return !one.front.empty() && condition(one); });
  };
  std::string html =
      "<h3>Error against run time</h3>\n<p class=\"caption\">All pipelines at all points of their sweeps. "
      "Bars: quartiles of the frame time; one standard uncertainty of the error, of the truth's noise and "
      "the spread over seeds together. Filled points are on the front of all: no other point is as good in "
      "both time and error and better in one by more than three standard uncertainties, "
      "so points within their uncertainties are both on it. The grey steps bound all points by their values "
      "alone. Coloured lines join the points of one pipeline that none of its own beats: the tables "
      "interpolate along them. The dashed grey line is the error of leaving the component out. Down and to "
      "the left is better." +
      basisOf(scene) + "</p>\n<p>" +
      (some([](const PipelineComparison&) { return true; })
           ? chooser("metric", sceneIndex, "Measure", kMetricTitles)
           : std::string()) +
      (some([](const PipelineComparison& one) { return one.bias; })
           ? chooser("against", sceneIndex, "Against", kAgainst)
           : std::string()) +
      "<span class=\"caption\">A few very bright pixels, such as the edges of a lamp, can rule the RMSE; the "
      "95th percentile and FLIP are less moved by them.</span></p>\n" +
      charts(sceneIndex, scene, components) +
      "<p class=\"caption\">In the tables below: the logarithm of the error is linear in that of the "
      "time between two measured points of one pipeline; nothing is extrapolated. &le;: the slowest "
      "(fastest) point measured has that much within the budget (the error) already. &plusmn;: one standard uncertainty, "
      "from those of both points through the interpolation. Bold: the least, and what cannot be told apart "
      "from it.</p>\n";
  // The whole picture is what a reader looks for first.
  for (auto it = components.rbegin(); it != components.rend(); ++it)
    html += componentTables(sceneIndex, scene, *it);
  return html;
}

const char* const kComparisonScript = R"js(
"use strict";
(function () {
  const { data, style, shortName, digits } = lumivoxPage;
  const titles = { rmse: "RMSE, W/(sr m²)", relative_mse: "relative MSE",
                   percentile95: "95th percentile of the error, W/(sr m²)", flip: "mean FLIP" };

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
        if (!dataset.bars || !chart.isDatasetVisible(index)) return;
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
      for (const level of chart.options.levels || []) {
        const at = y.getPixelForValue(level.value);
        if (at < chartArea.top || at > chartArea.bottom) continue;
        ctx.beginPath(); ctx.moveTo(chartArea.left, at); ctx.lineTo(chartArea.right, at); ctx.stroke();
        ctx.fillText(level.text, chartArea.left + 6, at - 4);
      }
      ctx.restore();
    }
  };

  // What a scene shows now. A component with one truth has one comparison, whatever it is to be judged against.
  const chosen = (scene, kind) =>
    (document.querySelector("select[data-choose=" + kind + "][data-scene='" + scene + "']") || {}).value;
  function shownOf(scene, list, of) {
    const fitting = list.filter(one => of(one).metric === chosen(scene, "metric"));
    return fitting.find(one => of(one).against === chosen(scene, "against")) || fitting[0];
  }
  const comparisonFor = canvas => shownOf(canvas.dataset.scene, data.analysed[canvas.dataset.scene].comparisons
    .filter(one => one.component === canvas.dataset.component), one => one);

  function drawn(comparison, index) {
    const point = comparison.points[index], time = point.frame_ms;
    const by = point.beaten_by === null ? null : comparison.points[point.beaten_by];
    return { x: time.median, y: point.error.value, low: time.lower_quartile, high: time.upper_quartile,
             uncertainty: point.error.uncertainty || 0, front: by === null,
             text: lumivoxPage.parameters(point) + ": " + digits(time.median) + " ms, " + digits(point.error.value) + " ± "
               + digits(point.error.uncertainty) + (by === null ? "; on the front"
               : "; beaten by " + shortName(by.file) + " (" + lumivoxPage.parameters(by) + ")") };
  }

  // The legend shows a pipeline's colour, whether its first point is hollow or not.
  const generateLabels = chart => Chart.defaults.plugins.legend.labels.generateLabels(chart)
    .map(label => ({ ...label, fillStyle: chart.data.datasets[label.datasetIndex].backgroundColor }));

  function errorChart(canvas) {
    const comparison = comparisonFor(canvas);
    const datasets = comparison.pipelines.map((pipeline, index) => {
      const own = comparison.points.map((point, at) => at).filter(at => comparison.points[at].pipeline === index
        && comparison.points[at].error.value > 0);
      const points = pipeline.front.concat(own.filter(at => !pipeline.front.includes(at))).map(at => drawn(comparison, at));
      const { colour, shape } = style(pipeline.file);
      return { label: shortName(pipeline.file), data: points, bars: true, showLine: true, borderWidth: 1.5, pointRadius: 5,
               borderColor: colour, backgroundColor: colour, pointStyle: shape,
               pointBackgroundColor: points.map(point => point.front ? colour : "#ffffff"),
               segment: { borderColor: segment => segment.p1DataIndex < pipeline.front.length ? undefined : "transparent" } };
    });
    const all = datasets.flatMap(set => set.data);
    const times = all.flatMap(point => [point.low, point.high]).filter(value => value > 0);
    const levelOf = comparison.metric !== "rmse" ? [] : data.analysed[canvas.dataset.scene].points.flatMap(point => point.errors)
      .filter(error => error.component === comparison.component && error.truth === comparison.truth && error.rmse_of_nothing > 0)
      .slice(0, 1).map(error => ({ value: error.rmse_of_nothing, text: "left out" }));
    const errors = all.map(point => point.y).concat(levelOf.map(level => level.value));
    const range = { left: Math.min(...times) / 1.3, right: Math.max(...times) * 1.3 };
    const steps = comparison.front.map(at => ({ x: comparison.points[at].frame_ms.median, y: comparison.points[at].error.value }));
    datasets.push({ label: "least error within a time", data: steps.concat([{ x: range.right, y: steps[steps.length - 1].y }]),
                    showLine: true, stepped: "before", pointRadius: 0, pointHitRadius: 0, borderWidth: 5, borderColor: "#0000001c",
                    backgroundColor: "#0000001c", pointStyle: "line" });
    new Chart(canvas, {
      type: "scatter", data: { datasets }, plugins: [errorBars, levels],
      options: {
        animation: false, maintainAspectRatio: false, levels: levelOf,
        scales: {
          x: { type: "logarithmic", title: { display: true, text: "frame time, ms" }, min: range.left, max: range.right,
               ticks: { maxRotation: 0, autoSkipPadding: 12 } },
          y: { type: "logarithmic", title: { display: true, text: titles[comparison.metric] },
               min: Math.min(...errors) / 1.5, max: Math.max(...errors) * 1.5 } },
        plugins: {
          legend: { position: "bottom", labels: { boxWidth: 14, font: { size: 11 }, usePointStyle: true, generateLabels } },
          tooltip: { filter: item => item.raw.text !== undefined,
                     callbacks: { label: item => item.dataset.label + ", " + item.raw.text } } } } });
  }

  const charts = [...document.querySelectorAll("canvas[data-chart=error]")];
  charts.forEach(errorChart);
  for (const choice of document.querySelectorAll("select[data-choose]"))
    choice.addEventListener("change", () => {
      const scene = choice.dataset.scene;
      for (const canvas of charts.filter(one => one.dataset.scene === scene)) {
        Chart.getChart(canvas).destroy();
        errorChart(canvas);
      }
      for (const details of document.querySelectorAll("details:has(> [data-tables='" + scene + "'])")) {
        const tables = [...details.children].filter(one => one.dataset.tables === scene);
        const shown = shownOf(scene, tables, one => one.dataset);
        for (const one of tables) one.hidden = one !== shown;
      }
    });
})();
)js";

}  // namespace lumivox::page
