// Plans the cells of a battery.
#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <set>

#include "lumivox/base/error.h"
#include "lumivox/experiment/report.h"
#include "lumivox/experiment/voxelizers.h"
#include "lumivox/pipeline/pass.h"
#include "stress/cases.h"

namespace lumivox {
namespace {

std::vector<std::filesystem::path> committedPipelines() {
  const auto scenes = committedScenes();
  if (!scenes)
    throw Error("no project with scenes and pipelines is around here; name pipelines with --pipeline");
  std::vector<std::filesystem::path> files = pipelinesIn(*scenes / "pipelines");
  if (const auto voxelizers = committedVoxelizers())
    for (const std::filesystem::path& file : pipelinesIn(*voxelizers)) files.push_back(file);
  return files;
}

/// The technique of the pass behind the first output other than direct light, or behind the first.
std::string techniqueOfOutputs(const Pipeline& pipeline, TechniqueSource& techniques) {
  std::string first;
  for (const Pipeline::Output& output : pipeline.outputs)
    for (const PassText& text : pipeline.passes) {
      if (text.name != output.pass) continue;
      if (first.empty()) first = text.technique;
      const Technique* technique = techniques.technique(text.technique);
      const PassEntry* entry = technique == nullptr ? nullptr : technique->find(text.pass);
      if (entry == nullptr) continue;
      const std::unique_ptr<Pass> pass = entry->make();
      for (const OutBase* port : pass->outputs())
        if (port->name() == output.port && port->contributes() != Contributes::direct) return text.technique;
    }
  return first;
}

bool chosen(const std::vector<std::string>& wanted, const std::string& name) {
  return wanted.empty() || std::any_of(wanted.begin(), wanted.end(), [&](const std::string& pattern) {
           return fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
         });
}

/// Refuses a word that matches nothing, which is a typing error.
void requireKnown(const char* what, const std::vector<std::string>& wanted,
                  const std::set<std::string>& known) {
  for (const std::string& word : wanted) {
    if (std::any_of(known.begin(), known.end(),
                    [&](const std::string& name) { return chosen({word}, name); }))
      continue;
    const std::string nearest = nearestWord(word, {known.begin(), known.end()});
    throw Error(fmt::format(
        "there is no {} '{}'{}", what, word,
        nearest.empty() ? "; `lumivox stress --list` shows all" : "; did you mean '" + nearest + "'?"));
  }
}

}  // namespace

std::string techniqueOf(const Pipeline& pipeline, TechniqueSource& techniques) {
  const std::string stem = pipeline.file.stem().string();
  std::string longest;
  for (const std::string& name : pipeline.techniques())
    if (stem.rfind(name, 0) == 0 && name.size() > longest.size()) longest = name;
  if (!longest.empty()) return longest;
  if (pipeline.passes.empty()) return {};
  return pipeline.outputs.empty() ? pipeline.passes.back().technique
                                  : techniqueOfOutputs(pipeline, techniques);
}

std::vector<StressJob> plannedStress(const StressOptions& options, TechniqueSource& techniques) {
  std::vector<StressJob> jobs;
  std::set<std::string> families, names, subjects;
  for (const std::filesystem::path& file :
       options.pipelines.empty() ? committedPipelines() : options.pipelines) {
    const Pipeline pipeline = Pipeline::load(file);
    checkPipeline(pipeline, techniques);
    const std::string subject = techniqueOf(pipeline, techniques);
    subjects.insert(subject);
    for (stress::Case& one : stress::casesFor(pipeline, techniques)) {
      families.insert(one.info.family);
      names.insert(one.info.name);
      if (!options.technique.empty() && subject != options.technique) continue;
      // A named case is run, quick or not.
      if (options.quick && options.cases.empty() && !one.info.quick) continue;
      if (chosen(options.families, one.info.family) && chosen(options.cases, one.info.name))
        jobs.push_back({std::move(one.info), file, subject});
    }
  }
  if (!options.technique.empty())
    requireKnown("technique that a pipeline here represents", {options.technique}, subjects);
  requireKnown("family of stress cases", options.families, families);
  requireKnown("stress case", options.cases, names);
  return jobs;
}

}  // namespace lumivox
