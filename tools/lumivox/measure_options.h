// The options of every command that measures pipelines on scenes: report, sweep, tune.
#pragma once

#include "command.h"
#include "common/display_options.h"
#include "lumivox/experiment/report.h"

namespace lumivox::command {

struct MeasureOptions {
  ReportOptions options;
  RunOptions run;
  DisplayOptions display;
  bool noSweep = false;
  bool quick = false;

  /// A command that writes images also adds --tone. `store` and `scenes`: what the help says of --store and
  /// of the positional texts.
  void addTo(CLI::App& app, const std::string& store,
             const std::string& scenes = "the scenes' texts or names");
  /// --budget. `order`: what the help says of the order of work.
  void addBudgetTo(CLI::App& app, const std::string& order);
  /// The options as the framework takes them. Pipeline texts among the positional texts count as pipelines.
  ReportOptions asked(const GlobalOptions& global, const std::string& doing = "measuring",
                      const std::string& unit = "points") const;

 private:
  CLI::Option *subpixels_ = nullptr, *repeats_ = nullptr, *seeds_ = nullptr;
};

/// Shows a command's progress in one line. `unit`: the plural of the counted items.
std::function<void(std::size_t, std::size_t, double)> progressLine(const std::string& what,
                                                                   const std::string& unit);

/// The global options that a command must repeat for the same result.
std::vector<std::string> repeatArguments(const GlobalOptions& global);
/// In a command that takes a frame time, adds a --budget that throws an Error which names --frame-time: in
/// all other commands a budget is time for measuring. The option is not in the help.
void refuseFrameTimeAsBudget(CLI::App& app);
/// "no time for 3 points; the same command goes on with them: COMMAND". If no point was begun, the budget
/// that suffices for the shortest (ReportSummary::neededSeconds).
std::string noTimeText(std::size_t points, double neededSeconds, const std::string& commandLine);
/// A number above 0. Error, with the option's name, for anything else.
double positiveNumberOf(const std::string& option, const std::string& text);

std::string quartilesText(
    const TimingStatistics& time);  ///< "1.2 [1.1, 1.4]", "1.2", "-" when nothing was timed
/// "cones=6 resolution=64"
std::string parametersText(const std::map<std::string, std::string>& parameters);
/// From this width of the terminal, in columns, tables show every output and all parameters. Narrower ones
/// have one line per point.
inline constexpr int kWideColumns = 120;
/// A name for each point: its pipeline and the parameters in which points of the same scene and pipeline
/// differ, as "direct samples=4".
std::vector<std::string> lineNames(const std::vector<const ReportPoint*>& points);
/// "0.0123 ± 0.0004", by kDefaultMetric; empty for null.
std::string errorText(const ComponentError* error);
/// The head of a column of errors. "FLIP, all light": the whole image against full transport. "FLIP, OUTPUT":
/// an output against the technique's own model.
std::string errorHeading(const std::string& output);
/// The outputs with an error at any of the points: those of indirect light first, the whole image last.
std::vector<std::string> judgedOutputs(const std::vector<const ReportPoint*>& points);
/// The line below such a table that explains its numbers.
extern const char* const kErrorNote;
/// The error of an output, against the reference of `bias` or else against the other reference. Null if there
/// is none.
const ComponentError* errorOf(const ReportPoint& point, const std::string& output, bool bias);

}  // namespace lumivox::command
