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

  /// A command that makes images adds --tone. `store`: the meaning of --store here; `scenes`: that of the
  /// positional texts.
  void addTo(CLI::App& app, const std::string& store,
             const std::string& scenes = "the scenes' texts or names");
  /// --budget; `order`: what is begun first.
  void addBudgetTo(CLI::App& app, const std::string& order);
  /// Everything that was asked for, in the words of the framework. Pipelines' texts among the scenes are
  /// pipelines.
  ReportOptions asked(const GlobalOptions& global, const std::string& doing = "measuring",
                      const std::string& unit = "points") const;

 private:
  CLI::Option *subpixels_ = nullptr, *repeats_ = nullptr, *seeds_ = nullptr;
};

/// Tells how far a command is by one line of progress; `unit`: the plural of what is counted.
std::function<void(std::size_t, std::size_t, double)> progressLine(const std::string& what,
                                                                   const std::string& unit);

/// The options of every command that a repeating one needs too.
std::vector<std::string> repeatArguments(const GlobalOptions& global);
/// A budget is time for measuring, in every command: in one that takes a frame's time, an Error names
/// --frame-time. In no help.
void refuseFrameTimeAsBudget(CLI::App& app);
/// "no time for 3 points; the same command goes on with them: COMMAND", or, where none was begun, the budget
/// that begins the shortest (ReportSummary::neededSeconds).
std::string noTimeText(std::size_t points, double neededSeconds, const std::string& commandLine);
/// A number above 0; Error with the option's name otherwise.
double positiveNumberOf(const std::string& option, const std::string& text);

std::string quartilesText(
    const TimingStatistics& time);  ///< "1.2 [1.1, 1.4]", "1.2", "-" when nothing was timed
/// "cones=6 resolution=64"
std::string parametersText(const std::map<std::string, std::string>& parameters);
/// So many columns have room for each output and all parameters; tables of fewer have one line a point.
inline constexpr int kWideColumns = 120;
/// For each point its pipeline, and of its parameters those in which the points of its scene and pipeline
/// differ: "direct samples=4".
std::vector<std::string> lineNames(const std::vector<const ReportPoint*>& points);
/// "0.0123 ± 0.0004", in kDefaultMetric. Empty for null.
std::string errorText(const ComponentError* error);
/// Over a column of them: "FLIP, all light" for the whole image, which is judged against full transport, else
/// "FLIP, OUTPUT", against the technique's own model.
std::string errorHeading(const std::string& output);
/// The outputs that any of the points was judged in, those of indirect light first, the whole image last.
std::vector<std::string> judgedOutputs(const std::vector<const ReportPoint*>& points);
/// The line below such a table: what the number is.
extern const char* const kErrorNote;
/// The error of an output by name: against the reference that is wanted, or the only one. Null when there is
/// none.
const ComponentError* errorOf(const ReportPoint& point, const std::string& output, bool bias);

}  // namespace lumivox::command
