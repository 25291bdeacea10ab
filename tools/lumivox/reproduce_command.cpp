// reproduce: tables of papers, measured here and compared.
#include <fmt/format.h>

#include <algorithm>

#include "command.h"
#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/log.h"
#include "lumivox/report/reproduce.h"
#include "measure_options.h"
#include "results_text.h"

namespace lumivox::command {
namespace {

namespace fs = std::filesystem;

struct ReproduceCommand {
  ReproduceOptions options;
  std::vector<std::string> names;
  fs::path output, store;
  bool list = false, json = false;
};

std::vector<PublishedTable> committedTables() {
  std::vector<PublishedTable> tables;
  for (const fs::path& file : committedReproductions()) tables.push_back(PublishedTable::load(file));
  if (tables.empty())
    throw AbsentError(
        "no published tables here: no *.reproduction in a folder scenes/reproductions in this folder or above, nor "
        "beside the program; name a file");
  return tables;
}

/// The tables of these names, or of these files; all committed ones without a name.
std::vector<PublishedTable> chosenTables(const std::vector<std::string>& names) {
  if (names.empty()) return committedTables();
  std::vector<PublishedTable> chosen;
  std::optional<std::vector<PublishedTable>> committed;
  for (const std::string& name : names) {
    if (fs::path(name).extension() == ".reproduction") {
      chosen.push_back(PublishedTable::load(name));
      continue;
    }
    if (!committed) committed = committedTables();
    std::vector<std::string> known;
    for (const PublishedTable& table : *committed) known.push_back(table.id);
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) {
      const std::string nearest = nearestWord(name, known);
      throw Error(fmt::format(
          "no published table is called '{}'; expected one of {}, or a file .reproduction{}", name,
          fmt::join(known, ", "), nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
    }
    chosen.push_back((*committed)[static_cast<std::size_t>(found - known.begin())]);
  }
  return chosen;
}

int list(const ReproduceCommand& command) {
  const std::vector<PublishedTable> tables = chosenTables(command.names);
  Json json = Json::array();
  std::vector<std::vector<std::string>> rows{{"Table", "Rows", "Measured", "Title", "Paper"}};
  for (const PublishedTable& table : tables) {
    const auto measured = std::count_if(table.rows.begin(), table.rows.end(),
                                        [](const PublishedRow& row) { return row.absent.empty(); });
    json.push_back({{"id", table.id},
                    {"title", table.title},
                    {"paper", table.paper},
                    {"file", table.file.string()},
                    {"rows", table.rows.size()},
                    {"measured", measured}});
    rows.push_back(
        {table.id, std::to_string(table.rows.size()), std::to_string(measured), table.title, table.paper});
  }
  if (command.json)
    printJson(json);
  else
    print(textTable(rows));
  return kGood;
}

Json rowJson(const PublishedRow& row, const MeasuredRow& measured, const JudgedRow& judged) {
  Json json{{"row", row.name},
            {"measures", name(row.quantity)},
            {"unit", unit(row.quantity)},
            {"published", row.published},
            {"published_ratio", jsonNumber(judged.publishedRatio)},
            {"ratio", jsonNumber(judged.ratio)},
            {"ratio_low", jsonNumber(judged.lowRatio)},
            {"ratio_high", jsonNumber(judged.highRatio)},
            {"verdict", name(judged.verdict)},
            {"why", judged.why},
            {"failed", measured.failed}};
  if (const auto& time = measured.measured)
    // Frame rates as times of frames: what is compared.
    json["measured"] = {{"median", time->median},
                        {"lower_quartile", time->lowerQuartile},
                        {"upper_quartile", time->upperQuartile},
                        {"repeats", time->repeats}};
  return json;
}

Json tableJson(const ReproducedTable& table) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    rows.push_back(rowJson(table.table.rows[i], table.rows[i], table.judged.rows[i]));
  return {{"id", table.table.id},
          {"title", table.table.title},
          {"paper", table.table.paper},
          {"published_on", table.table.device},
          {"device", table.device.renderer},
          {"driver", table.device.version},
          {"software", table.device.software},
          {"host", table.host},
          {"date", table.date},
          {"scale", table.scale},
          {"verdict", name(table.judged.verdict)},
          {"why", table.judged.why},
          {"rows", rows},
          {"set_ups", table.setUps},
          {"differences", table.table.differences},
          {"command", table.command}};
}

std::string tableText(const ReproducedTable& table) {
  std::vector<std::vector<std::string>> rows{
      {"Row", "Published", "Measured", "Published ratio", "Measured ratio", "Verdict"}};
  for (std::size_t i = 0; i < table.rows.size(); ++i)
    rows.push_back(reproductionCells(table.table.rows[i], table.rows[i], table.judged.rows[i]));
  std::string text = fmt::format("{}: {} ({})\n", table.table.id, table.table.title, table.table.paper);
  text += textTable(rows);
  for (const std::string& note : reproductionNotes(table)) text += note + "\n";
  return text + verdictText(table) + "\n";
}

void write(const fs::path& output, const std::vector<ReproducedTable>& tables) {
  writeFileAtomically(
      output, output.extension() == ".md" ? reproductionsAsMarkdown(tables) : reproductionsAsHtml(tables));
}

int reproduce(const ReproduceCommand& command, const GlobalOptions& global) {
  if (command.list) return list(command);
  if (!command.output.empty()) {
    if (command.output.extension() != ".md" && command.output.extension() != ".html")
      throw Error(fmt::format("{}: the tables are written as .html or .md", command.output.string()));
    requireWritable(command.output);
  }
  const std::vector<PublishedTable> chosen = chosenTables(command.names);
  ReproduceOptions options = command.options;
  options.repeatArguments = repeatArguments(global);
  std::optional<ResultsStore> store;
  if (!command.store.empty()) store.emplace(command.store);
  TechniqueSet techniques = global.techniqueSet();
  const auto device = global.openDevice();
  std::vector<ReproducedTable> tables;
  Json json = Json::array();
  bool failed = false;
  for (const PublishedTable& table : chosen) {
    logInformation("{}: {}", table.id, table.title);
    tables.push_back(lumivox::reproduce(
        *device, techniques, table, options, [&](const fs::path& file) { return global.loadScene(file); },
        store ? &*store : nullptr));
    for (const MeasuredRow& row : tables.back().rows) failed = failed || row.failed;
    if (command.json)
      json.push_back(tableJson(tables.back()));
    else
      print(tableText(tables.back()) + "\n");
  }
  if (command.json) printJson(json);
  if (!command.output.empty()) write(command.output, tables);
  return failed ? kNotGood : kGood;
}

}  // namespace

void addReproduceCommand(Commands& commands) {
  auto* command = commands.app.add_subcommand(
      "reproduce", "measures the set-ups of published tables and compares the numbers as ratios");
  auto all = std::make_shared<ReproduceCommand>();
  command->add_option("TABLE", all->names,
                      "names of tables, or texts .reproduction (default: all committed ones)");
  command->add_flag("--list", all->list, "only list the tables");
  command
      ->add_option(
          "--scale", all->options.scale,
          "reduces picture sides and grids by this factor (default: 1, or what the table says for a software "
          "rasteriser)")
      ->check(CLI::Range(1.0 / 64, 1.0));
  command->add_option("--repeats", all->options.repeats, "timed frames of each set-up (default 5)")
      ->check(CLI::Range(1, 10000));
  command->add_option("--seed", all->options.seed, "of the random numbers of techniques");
  command->add_option("-o,--out", all->output, "writes the tables as a page, .html or .md");
  auto* store = command->add_option(
      "--store", all->store,
      "a results store that takes the set-ups: times, and errors and work, which are measured "
      "after them (default: none)");
  command
      ->add_option("--spp", all->options.truthSamples,
                   "samples per pixel of the truth of those errors (default: by the picture's size)")
      ->check(CLI::Range(1, 1 << 24))
      ->needs(store);
  command->add_flag("--json", all->json, "print JSON in place of the tables");
  const GlobalOptions& global = commands.global;
  commands.onChosen(command, [=, &global] { return reproduce(*all, global); });
}

}  // namespace lumivox::command
