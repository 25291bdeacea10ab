// Texts that consist of sweep blocks.
#include "lumivox/pipeline/sweep_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "dsl/consequences.h"
#include "pipeline/read_sweep.h"
#include "pipeline/text_values.h"

namespace lumivox {
namespace {

SweepText sweepOf(dsl::Document parsed) {
  SweepText text;
  const auto document = std::make_shared<const dsl::Document>(std::move(parsed));
  text.file = document->file;
  text.document = document;
  std::vector<Diagnostic> findings = document->findings;
  bool outside = false;
  for (const dsl::Item& item : document->items) {
    if (item.property && item.property->word != "sweep" && !item.property->values.empty() &&
        item.property->values[0].kind == dsl::ValueKind::list) {
      if (!std::exchange(outside, true)) dsl::reportOutside(*document, item, "sweep", findings);
      continue;
    }
    if (!item.block || item.block->word != "sweep") {
      const std::string& word = item.block ? item.block->word : item.property->word;
      findings.push_back(document->finding(
          item.block ? item.block->place : item.property->place, static_cast<int>(word.size()),
          fmt::format("unknown {} '{}' in a text of sweeps", item.block ? "block" : "statement", word),
          "sweep NAME { ... }", nearestWord(word, {"sweep"})));
      continue;
    }
    SweepBlock sweep = readSweepBlock(*document, *item.block, SweepHome::text, findings);
    for (const SweepBlock& other : text.sweeps)
      if (other.name == sweep.name)
        findings.push_back(
            document->finding(sweep.place, 1, fmt::format("a second sweep named '{}'", sweep.name)));
    text.sweeps.push_back(std::move(sweep));
  }
  if (text.sweeps.empty() && findings.empty())
    findings.push_back(document->finding({document->file.string(), 0, 0}, 1, "the text has no sweep block",
                                         "sweep NAME { scenes [...] pipelines [...] }"));
  dsl::dropConsequences(*document, findings);
  throwOrLog(std::move(findings));
  return text;
}

}  // namespace

SweepText SweepText::load(const std::filesystem::path& file) {
  return sweepOf(dsl::parseFile(file));
}

SweepText SweepText::parse(std::string source, std::filesystem::path file) {
  dsl::Document document = dsl::parse(std::move(source), std::move(file));
  dsl::resolveIncludes(document);
  return sweepOf(std::move(document));
}

std::vector<SweepShare> sweepShares(const SweepText& text, TechniqueSource& techniques,
                                    std::vector<std::string>& notes) {
  std::vector<SweepShare> shares;
  std::vector<Diagnostic> findings;
  std::map<std::filesystem::path, std::shared_ptr<const Pipeline>> loaded;
  const auto collect = [&](const auto& work) {
    try {
      work();
    } catch (const DiagnosticsError& error) {
      findings.insert(findings.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
  };
  for (std::size_t i = 0; i < text.sweeps.size(); ++i) {
    const SweepBlock& block = text.sweeps[i];
    std::map<const SweepAxis*, std::vector<std::string>> without;  // pipelines that lack an axis
    for (const std::filesystem::path& file : block.pipelines) {
      const bool isNew = !loaded.contains(file);
      std::shared_ptr<const Pipeline>& pipeline = loaded[file];
      if (isNew)
        collect([&] {
          auto read = std::make_shared<const Pipeline>(Pipeline::load(file));
          checkPipeline(*read, techniques);
          pipeline = std::move(read);
        });
      if (!pipeline) continue;
      std::vector<const SweepAxis*> lacking;
      SweepShare share{i, pipeline, fittedSweep(block, *pipeline, *text.document, findings, lacking)};
      for (const SweepAxis* axis : lacking) without[axis].push_back(pipeline->name);
      // The values must also fit the passes, as in the pipeline's own text.
      Pipeline swept = *pipeline;
      swept.sweeps.push_back(share.sweep);
      collect([&] { checkPipeline(swept, techniques); });
      shares.push_back(std::move(share));
    }
    for (const SweepAxis& axis : block.axes) {
      const auto missing = without.find(&axis);
      if (missing == without.end()) continue;
      if (missing->second.size() == block.pipelines.size()) {
        std::vector<std::string> names;
        for (const SweepShare& share : shares)
          if (share.block == i)
            for (std::string& name : parameterNames(*share.pipeline))
              if (std::find(names.begin(), names.end(), name) == names.end())
                names.push_back(std::move(name));
        findings.push_back(text.document->finding(
            axis.place, static_cast<int>(axis.parameter.size()),
            fmt::format("no pipeline of the sweep has a parameter '{}'", axis.parameter),
            oneOf(names, "no axis, since the pipelines declare no parameters"),
            nearestWord(axis.parameter, names)));
        continue;
      }
      for (const std::string& name : missing->second)
        notes.push_back(
            fmt::format("{}: pipeline \"{}\" has no parameter '{}' and is measured without that axis",
                        axis.place.text(), name, axis.parameter));
    }
  }
  throwOrLog(std::move(findings));
  return shares;
}

const std::vector<dsl::BlockSpecification>& sweepSpecifications() {
  static const std::vector<dsl::BlockSpecification> specifications = {sweepSpecification(SweepHome::text)};
  return specifications;
}

}  // namespace lumivox
