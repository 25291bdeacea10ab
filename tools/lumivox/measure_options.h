// The options of every command that measures pipelines on scenes: report, sweep, tune.
#pragma once

#include "command.h"
#include "lumivox/experiment/report.h"

namespace lumivox::command {

struct MeasureOptions {
  ReportOptions options;
  RunOptions run;
  DisplayOptions display;
  bool noSweep = false;

  /// A command that makes images adds --tone. `store`: the meaning of --store here; `scenes`: that of the
  /// positional texts.
  void addTo(CLI::App& app, const std::string& store, const std::string& scenes = "the scenes' texts");
  /// Everything that was asked for, in the words of the framework.
  ReportOptions asked(const GlobalOptions& global) const;
};

/// The options of every command that a repeating one needs too.
std::vector<std::string> repeatArguments(const GlobalOptions& global);
/// "16ms", "0.016 s" or "16" (milliseconds); Error with the option's name otherwise.
double millisecondsOf(const std::string& option, const std::string& text);
/// A number above 0; Error with the option's name otherwise.
double positiveNumberOf(const std::string& option, const std::string& text);

std::string durationText(double seconds);                 ///< "12 s", "4 min", "1.5 h"
std::string quartilesText(const TimingStatistics& time);  ///< "1.2 [1.1, 1.4]"; "-" when nothing was timed
/// "cones=6 resolution=64"
std::string parametersText(const std::map<std::string, std::string>& parameters);
/// "0.0123 ± 0.0004 (0.31)": RMSE, and in brackets its ratio to leaving the component out. Empty for null.
std::string rmseText(const ComponentError* error);
/// The error of an output by name: against the reference that is wanted, or the only one. Null when there is
/// none.
const ComponentError* errorOf(const ReportPoint& point, const std::string& output, bool bias);

}  // namespace lumivox::command
