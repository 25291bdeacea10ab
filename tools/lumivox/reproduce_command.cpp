// reproduce: measures tables and figures of papers and compares them; keeps the results, and writes the cards
// that quote them.
#include <fmt/format.h>

#include <algorithm>
#include <iostream>

#include "command.h"
#include "common/outputs.h"
#include "describe_json.h"
#include "lumivox/analysis/judge.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/image.h"
#include "lumivox/base/interruption.h"
#include "lumivox/base/log.h"
#include "lumivox/experiment/report.h"
#include "lumivox/experiment/reproduce.h"
#include "lumivox/page/contact_sheet.h"
#include "lumivox/page/measured_passages.h"
#include "lumivox/page/published_passages.h"
#include "lumivox/page/reproduction_page.h"
#include "measure_options.h"
#include "results_text.h"

namespace lumivox::command {
namespace {

namespace fs = std::filesystem;

struct ReproduceCommand {
  ReproduceOptions options;
  std::vector<std::string> names;
  fs::path output, store, record, figures = "out/reproductions";
  bool list = false, json = false, cards = false, check = false;
};

std::vector<PublishedResult> committedTables() {
  std::vector<PublishedResult> tables;
  for (const fs::path& file : committedReproductions()) tables.push_back(PublishedResult::load(file));
  if (tables.empty())
    throw AbsentError(
        "no published tables or figures here: no *.reproduction in a folder scenes/reproductions in this folder or above, nor "
        "beside the program; name a file");
  return tables;
}

/// The published results of these names or files; all committed ones if there are none.
std::vector<PublishedResult> chosenTables(const std::vector<std::string>& names) {
  if (names.empty()) return committedTables();
  std::vector<PublishedResult> chosen;
  std::optional<std::vector<PublishedResult>> committed;
  for (const std::string& name : names) {
    if (fs::path(name).extension() == ".reproduction") {
      chosen.push_back(PublishedResult::load(name));
      continue;
    }
    if (!committed) committed = committedTables();
    const auto found = std::find_if(committed->begin(), committed->end(), [&](const PublishedResult& table) {
      return name == table.id || name == citedName(table);
    });
    if (found == committed->end()) {
      std::vector<std::string> cited;
      for (const PublishedResult& table : *committed) cited.push_back(citedName(table));
      std::vector<std::string> known = cited;
      for (const PublishedResult& table : *committed) known.push_back(table.id);
      const std::string nearest = nearestWord(name, known);
      throw Error(fmt::format(
          "no published table or figure is called '{}'; expected one of {}, or a file .reproduction{}", name,
          fmt::join(cited, ", "), nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
    }
    chosen.push_back(*found);
  }
  return chosen;
}

int list(const ReproduceCommand& command) {
  const std::vector<PublishedResult> results = chosenTables(command.names);
  Json json = Json::array();
  std::vector<std::vector<std::string>> rows{{"Name", "Title"}};
  for (const PublishedResult& result : results) {
    const std::vector<const PublishedSetUp*> setUps = result.setUps();
    const auto measured = std::count_if(setUps.begin(), setUps.end(),
                                        [](const PublishedSetUp* one) { return one->absent.empty(); });
    json.push_back({{"id", result.id},
                    {"name", citedName(result)},
                    {"title", result.title},
                    {"paper", result.paper},
                    {"file", result.file.string()},
                    {"rows", result.rows.size()},
                    {"curves", result.curves.size()},
                    {"panels", result.panels.size()},
                    {"measured", measured}});
    // The table shows counts only where something cannot be measured; the JSON always has them.
    const bool isWhole = static_cast<std::size_t>(measured) == setUps.size();
    rows.push_back({citedName(result),
                    isWhole ? result.title
                            : fmt::format("{} ({} of {} measured)", result.title, measured, setUps.size())});
  }
  if (command.json)
    printJson(json);
  else
    print(textTable(rows));
  return kGood;
}

std::string resultText(const ReproducedResult& result, const std::vector<fs::path>& files) {
  std::string text = fmt::format("{}: {} ({})\n", citedName(result.published), result.published.title,
                                 result.published.paper);
  if (!result.rows.empty()) {
    std::vector<std::vector<std::string>> rows{reproductionHeadings()};
    for (std::string& heading : rows.front())
      heading.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(heading.front())));
    for (std::size_t i = 0; i < result.rows.size(); ++i)
      rows.push_back(reproductionCells(result.rows[i], result.judged.rows[i]));
    text += textTable(rows);
  }
  for (std::size_t i = 0; i < result.curves.size(); ++i)
    text +=
        fmt::format("{}: {}\n", result.curves[i].name, curveText(result.curves[i], result.judgedCurves[i]));
  for (const ShownPanel& panel : result.panels)
    if (!panel.whyNot.empty()) text += fmt::format("{}: {}\n", panel.name, panel.whyNot);
  for (std::size_t i = 0; i < result.claims.size(); ++i)
    text += claimText(result.claims[i], result.judgedClaims[i]) + "\n";
  for (const fs::path& file : files) text += "Written: " + file.string() + "\n";
  for (const std::string& note : reproductionNotes(result)) text += note + "\n";
  const std::string verdict = verdictText(result);
  return verdict.empty() ? text : text + verdict + "\n";
}

/// Writes the sheet and the curves of a figure; nothing for a table.
std::vector<fs::path> writeFigures(const fs::path& folder, const ReproducedResult& result) {
  std::vector<fs::path> files;
  const auto add = [&](const char* extension, const std::string& content) {
    files.push_back(folder / (result.published.id + extension));
    writeFileAtomically(files.back(), content);
  };
  if (!result.panels.empty()) add(".png", encodePng(contactSheet(result)));
  if (!result.curves.empty()) {
    add(".csv", curvesAsCsv(result));
    add(".svg", curvesAsSvg(result));
  }
  return files;
}

// ---- what is kept, and who quotes it

/// The project's folder, which contains the committed scenes.
fs::path projectFolder() {
  const auto scenes = committedScenes();
  if (!scenes)
    throw AbsentError(
        "no project here: no folder scenes with pipelines in this folder or above, nor beside the program");
  return scenes->parent_path();
}

/// Replaces the measured results in the file, and keeps all others.
void record(const fs::path& file, const std::vector<ReproducedResult>& measured) {
  std::vector<ReproducedResult> kept;
  if (fs::exists(file)) kept = judged(readReproductions(file));
  for (const ReproducedResult& result : measured) {
    const auto known = std::find_if(kept.begin(), kept.end(), [&](const ReproducedResult& one) {
      return one.published.id == result.published.id;
    });
    if (known == kept.end())
      kept.push_back(result);
    else
      *known = result;
  }
  std::sort(kept.begin(), kept.end(), [](const ReproducedResult& a, const ReproducedResult& b) {
    return a.published.id < b.published.id;
  });
  writeFileAtomically(file, reproductionsAsJson(kept));
}

/// The number of the first line in which two texts differ.
std::size_t firstDifference(const std::string& one, const std::string& other) {
  const auto place = std::mismatch(one.begin(), one.end(), other.begin(), other.end()).first;
  return 1 + static_cast<std::size_t>(std::count(one.begin(), place, '\n'));
}

/// The published values of the parameters of all available techniques.
std::vector<PublishedParameter> publishedParameters(const GlobalOptions& global) {
  TechniqueSet techniques = global.techniqueSet();
  std::vector<PublishedParameter> all;
  forEachPass(techniques, [&](const Technique& technique, const PassEntry& entry) {
    const std::unique_ptr<Pass> pass = entry.make();
    for (const ParamBase* one : pass->parameters())
      if (const std::string published = one->publishedText(); !published.empty())
        all.push_back({technique.name, entry.name, one->name(), published, one->defaultText()});
  });
  return all;
}

/// Writes the page of kept results and every generated passage of the cards and guides. With --check, only
/// reports where one differs.
int writeCards(const ReproduceCommand& command, const GlobalOptions& global) {
  const fs::path project = projectFolder(), page = project / "docs/benchmarks/reproductions.md";
  const std::vector<ReproducedResult> results = judged(readReproductions(
      command.record.empty() ? project / "docs/benchmarks/reproductions.json" : command.record));
  std::vector<std::pair<fs::path, std::string>> texts{{page, reproductionsAsMarkdown(results)}};
  std::vector<fs::path> quoting;
  for (const char* folder : {"techniques", "docs"})
    if (fs::is_directory(project / folder))
      for (const auto& entry : fs::recursive_directory_iterator(project / folder))
        if (entry.path().extension() == ".md" && entry.path() != page) quoting.push_back(entry.path());
  std::sort(quoting.begin(), quoting.end());
  const fs::path tables = project / "docs/benchmarks/measured_tables.json";
  const std::vector<MeasuredTable> measured =
      fs::exists(tables) ? readMeasuredTables(tables) : std::vector<MeasuredTable>();
  const std::vector<PublishedParameter> published = publishedParameters(global);
  for (const fs::path& file : quoting) {
    const std::string reproduced = withReproducedPassages(readFile(file), file, results);
    texts.emplace_back(
        file, withPublishedPassages(withMeasuredPassages(reproduced, file, measured), file, published));
  }

  bool good = true;
  const auto complain = [&](const std::string& what) {
    std::cerr << "lumivox: " << what << "\n";
    good = false;
  };
  for (const std::string& stale : staleReproductions(results, committedTables()))
    complain(stale + "; measure it again with --record");
  for (const auto& [file, text] : texts) {
    const std::string is = fs::exists(file) ? readFile(file) : std::string();
    if (is == text) continue;
    if (command.check) {
      complain(fmt::format(
          "{}:{}: this differs from the measurement or declaration; lumivox reproduce --cards rewrites it",
          file.string(), firstDifference(is, text)));
    } else {
      writeFileAtomically(file, text);
      logInformation("{}: written", file.string());
    }
  }
  return good ? kGood : kNotGood;
}

void write(const fs::path& output, const std::vector<ReproducedResult>& results) {
  writeFileAtomically(
      output, output.extension() == ".md" ? reproductionsAsMarkdown(results) : reproductionsAsHtml(results));
}

/// The message of an interruption after this many of the chosen results.
std::string keptText(const ReproduceCommand& command, const std::vector<PublishedResult>& chosen,
                     std::size_t done, const GlobalOptions& global) {
  std::vector<std::string> rest;
  for (std::size_t i = done; i < chosen.size(); ++i) rest.push_back(citedName(chosen[i]));
  const std::string kept =
      !command.record.empty() ? fmt::format("{} keeps {} of {}", command.record.string(), done, chosen.size())
      : !command.store.empty()
          ? fmt::format("{} keeps the set-ups of {} of {}", command.store.string(), done, chosen.size())
          : std::string("nothing is kept without --record or --store");
  return fmt::format("interrupted: {}; still to measure: {}; to go on, name them in {}", kept,
                     fmt::join(rest, " "), global.commandLine);
}

int measure(const ReproduceCommand& command, const GlobalOptions& global) {
  std::vector<fs::path> inputs{command.store};
  inputs.insert(inputs.end(), command.names.begin(), command.names.end());
  Outputs()
      .add("-o", command.output, {".html", ".md"})
      .add("--record", command.record, {".json"}, Outputs::Endings::otherKindsRefused)
      .check(inputs);
  if (!command.record.empty()) {
    if (fs::exists(command.record)) readReproductions(command.record);  // a damaged file throws here
  }
  const std::vector<PublishedResult> chosen = chosenTables(command.names);
  const bool traces = std::any_of(chosen.begin(), chosen.end(), [](const PublishedResult& result) {
    return std::any_of(result.panels.begin(), result.panels.end(),
                       [](const PublishedPanel& panel) { return !panel.reference.empty(); });
  });
  if (command.options.referenceSamples > 0 && command.store.empty() && !traces)
    throw Error(
        "--spp: nothing is path traced here; expected --store, or a figure with a panel of the reference");
  for (const PublishedResult& result : chosen)
    if (!result.panels.empty() || !result.curves.empty()) {
      requireWritable(command.figures / (result.id + ".png"));
      break;
    }
  ReproduceOptions options = command.options;
  options.repeatArguments = repeatArguments(global);
  std::optional<ResultsStore> store;
  if (!command.store.empty()) store.emplace(command.store);
  TechniqueSet techniques = global.techniqueSet();
  const auto device = global.openDevice();
  std::vector<ReproducedResult> results;
  bool failed = false;
  InterruptionNote note;
  for (const PublishedResult& result : chosen) {
    const std::string name = citedName(result);
    logInformation("{}: {}", name, result.title);
    options.progress = progressLine(
        chosen.size() == 1 ? name : fmt::format("{} ({} of {})", name, results.size() + 1, chosen.size()),
        "steps");
    note.say(keptText(command, chosen, results.size(), global));
    results.push_back(lumivox::reproduce(
        *device, techniques, result, options, [&](const fs::path& file) { return global.loadScene(file); },
        store ? &*store : nullptr));
    failed = failed || results.back().failed();
    const std::vector<fs::path> files = writeFigures(command.figures, results.back());
    // Recorded one by one, so that an interruption loses only the current one.
    if (!command.record.empty()) record(command.record, {results.back()});
    options.progress = {};
    if (!command.json) print(resultText(results.back(), files) + "\n");
  }
  if (command.json) printJson(Json::parse(reproductionsAsJson(results)).at("results"));
  if (!command.output.empty()) write(command.output, results);
  return failed ? kNotGood : kGood;
}

int reproduce(const ReproduceCommand& command, const GlobalOptions& global) {
  if (command.list) return list(command);
  int code = kGood;
  // --check, and --cards without names or --record, measure nothing.
  const bool onlyCards = command.check || (command.cards && command.record.empty() && command.names.empty());
  if (!onlyCards) code = measure(command, global);
  return command.cards ? std::max(code, writeCards(command, global)) : code;
}

}  // namespace

void addReproduceCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand(
      "reproduce",
      "measures the set-ups of published tables and figures, compares numbers as ratios, and makes the images");
  auto all = std::make_shared<ReproduceCommand>();
  command->add_option(
      "NAME", all->names,
      "names of tables and figures as --list prints them, or texts .reproduction (default: all committed ones)");
  command->add_flag("--list", all->list, "only list them");
  command
      ->add_option(
          "--scale", all->options.scale,
          "reduces image sides and grids by this factor (default: 1, or what the text says for a software "
          "rasteriser)")
      ->check(numberBetween(1.0 / 64, 1.0));
  command->add_option("--repeats", all->options.repeats, "timed frames of each set-up (default 5)")
      ->check(CLI::Range(1, 10000));
  addSeed(*command, all->options.seed);
  command->add_option("-o,--out", all->output, "writes the results as a page, .html or .md");
  command->add_option("--figures", all->figures,
                      "folder for sheets (.png) and curves (.csv, .svg) (default: out/reproductions)");
  auto* recordOption = command->add_option(
      "--record", all->record, "a file .json that keeps the results: newly measured ones replace its own");
  auto* cards = command->add_flag(
      "--cards", all->cards,
      "writes docs/benchmarks/reproductions.md and the generated passages of cards and guides: kept results and published values; "
      "alone, from docs/benchmarks/reproductions.json and without measuring");
  command->add_flag("--check", all->check, "with --cards: writes nothing, and reports what would change")
      ->needs(cards);
  command->add_option(
      "--store", all->store,
      "a results store that takes the set-ups: times, and errors and work, which are measured "
      "after them (default: none)");
  command
      ->add_option(
          "--spp", all->options.referenceSamples,
          "samples per pixel of the reference, of those errors and of panels (default: by the image's size)")
      ->check(CLI::Range(1, 1 << 24));
  command->add_flag("--json", all->json, "print JSON in place of text");
  recordOption->excludes("--list");
  const GlobalOptions& global = commands.global;
  commands.onChosen(command, [=, &global] { return reproduce(*all, global); });
}

}  // namespace lumivox::command
