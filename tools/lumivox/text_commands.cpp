// check and fmt: faults of texts, and their layout.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "command.h"
#include "common/named_texts.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/findings.h"
#include "lumivox/base/log.h"
#include "lumivox/dsl/document.h"
#include "lumivox/experiment/reproduce.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/pipeline/sweep_text.h"
#include "lumivox/results/reproduction.h"
#include "lumivox/scene/text.h"
#include "viewer/actions.h"

namespace lumivox::command {
namespace {

namespace fs = std::filesystem;

// ---- check

Json findingAsJson(const Diagnostic& finding) {
  return {{"file", finding.place.file},
          {"line", finding.place.line},
          {"column", finding.place.column},
          {"severity", finding.severity == Diagnostic::Severity::error ? "error" : "warning"},
          {"what", finding.what},
          {"expected", finding.expected},
          {"suggestion", finding.suggestion}};
}

/// Findings in one file with their places, or one message for an error without a place.
struct CheckedFile {
  std::vector<Diagnostic> findings;
  std::string message;
  std::size_t warnings() const {
    return static_cast<std::size_t>(std::count_if(
        findings.begin(), findings.end(),
        [](const Diagnostic& finding) { return finding.severity == Diagnostic::Severity::warning; }));
  }
  bool good() const { return findings.size() == warnings() && message.empty(); }
};

/// Checks a scene without the messages on its models, which only --verbose shows.
void checkLoading(const fs::path& file, const GlobalOptions& global) {
  const LogLevel level = logLevel();
  if (!global.verbose && level > LogLevel::warnings) setLogLevel(LogLevel::warnings);
  try {
    checkScene(file, global.sceneLoad());
  } catch (...) {
    setLogLevel(level);
    throw;
  }
  setLogLevel(level);
}

CheckedFile checkFile(const fs::path& file, const GlobalOptions& global, TechniqueSet& techniques) {
  CheckedFile checked;
  const WarningCollector collector;
  try {
    switch (kindOfText(file)) {
      case TextKind::scene:
        checkLoading(file, global);
        break;
      case TextKind::pipeline:
        checkPipeline(Pipeline::load(file), techniques);
        break;
      case TextKind::sweep: {
        std::vector<std::string> notes;
        sweepShares(SweepText::load(file), techniques, notes);
        for (const std::string& note : notes) logInformation("{}", note);
        break;
      }
      case TextKind::view:
        viewer::readScript(file);
        break;
      case TextKind::reproduction:
        checkReproduction(PublishedResult::load(file), techniques);
        break;
    }
  } catch (const DiagnosticsError& error) {
    checked.findings = error.diagnostics();
  } catch (const Error& error) {
    checked.message = error.what();
  }
  // The pipelines of a sweep may give the same warning at every point.
  std::vector<Diagnostic> findings = checked.findings;
  std::set<std::string> known;
  for (const Diagnostic& finding : findings) known.insert(finding.text());
  for (const Diagnostic& warning : collector.findings())
    if (known.insert(warning.text()).second) findings.push_back(warning);
  checked.findings = DiagnosticsError(std::move(findings)).diagnostics();  // in the order of the text
  return checked;
}

std::string warningsText(std::size_t count) {
  return count == 0 ? "" : fmt::format(", with {} warning{}", count, count == 1 ? "" : "s");
}

std::string errorsText(const CheckedFile& checked) {
  const std::size_t count = checked.findings.size() - checked.warnings() + (checked.message.empty() ? 0 : 1);
  return fmt::format("{} error{}", count, count == 1 ? "" : "s");
}

int check(const std::vector<fs::path>& files, bool json, const GlobalOptions& global) {
  TechniqueSet techniques = global.techniqueSet();
  Json list = Json::array();
  std::size_t bad = 0;
  for (const fs::path& file : files) {
    const CheckedFile checked = checkFile(file, global, techniques);
    if (!checked.good()) ++bad;
    if (json) {
      Json findings = Json::array();
      const std::size_t shown = shownFindings(checked.findings.size());
      for (std::size_t i = 0; i < shown; ++i) findings.push_back(findingAsJson(checked.findings[i]));
      if (!checked.message.empty())
        findings.push_back({{"file", file.string()}, {"severity", "error"}, {"what", checked.message}});
      list.push_back({{"file", file.string()},
                      {"good", checked.good()},
                      {"findings", std::move(findings)},
                      {"more_findings", checked.findings.size() - shown}});
      continue;
    }
    if (!checked.findings.empty()) std::cerr << DiagnosticsError(checked.findings).what() << "\n";
    if (!checked.message.empty()) std::cerr << "lumivox: " << checked.message << "\n";
    if (!checked.good() && !global.quiet)
      std::cerr << file.string() << ": " << errorsText(checked) << warningsText(checked.warnings()) << "\n";
    if (checked.good() && !global.quiet)
      print(file.string() + ": good" + warningsText(checked.warnings()) + "\n");
  }
  if (json) printJson(list);
  return bad == 0 ? kGood : kBadInput;
}

// ---- fmt

int formatFiles(const std::vector<fs::path>& files, bool onlyCheck, bool json, bool quiet) {
  // All files are read before the first is written, so that one wrong text leaves all files unchanged.
  std::vector<Diagnostic> findings;
  std::vector<std::pair<fs::path, std::string>> changed;
  for (const fs::path& file : files) {
    std::string source = readFile(file);
    const dsl::Document document = dsl::parse(source, file);
    findings.insert(findings.end(), document.findings.begin(), document.findings.end());
    if (!document.findings.empty()) continue;
    std::string formatted = dsl::format(document);
    if (formatted != source) changed.emplace_back(file, std::move(formatted));
  }
  if (!findings.empty()) throw DiagnosticsError(findings);
  Json list = Json::array();
  for (const fs::path& file : files)
    list.push_back({{"file", file.string()},
                    {"changed", std::any_of(changed.begin(), changed.end(),
                                            [&](const auto& one) { return one.first == file; })}});
  for (const auto& [file, text] : changed) {
    if (onlyCheck) {
      if (!json) print(file.string() + ": would be reformatted\n");
    } else {
      writeFileAtomically(file, text);
      if (!quiet && !json) print(file.string() + ": reformatted\n");
    }
  }
  if (json) printJson(list);
  return onlyCheck && !changed.empty() ? kNotGood : kGood;
}

}  // namespace

void addTextCommands(Commands& commands) {
  const GlobalOptions& global = commands.global;
  {
    auto* command = commands.app.add_subcommand("check", "finds all errors in texts");
    auto files = std::make_shared<std::vector<fs::path>>();
    auto json = std::make_shared<bool>(false);
    takesNames(
        command->add_option("FILE", *files, "scenes, pipelines, sweeps and published tables")->required(),
        NamedText::sceneOrPipeline);
    command->add_flag("--json", *json, "print the findings as JSON");
    commands.onChosen(command, [=, &global] { return check(*files, *json, global); });
  }
  {
    auto* command = commands.app.add_subcommand("fmt", "formats texts in the canonical way");
    auto files = std::make_shared<std::vector<fs::path>>();
    auto onlyCheck = std::make_shared<bool>(false);
    command->add_option("FILE", *files, "scenes, pipelines, sweeps and published tables")->required();
    command->add_flag("--check", *onlyCheck, "change nothing; exit code 1 when a file would change");
    auto json = std::make_shared<bool>(false);
    command->add_flag("--json", *json, "print which files change as JSON");
    commands.onChosen(command, [=, &global] { return formatFiles(*files, *onlyCheck, *json, global.quiet); });
  }
}

}  // namespace lumivox::command
