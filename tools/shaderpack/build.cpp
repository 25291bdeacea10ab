#include "build.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>
#include <thread>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"

namespace lumivox::shaderpack {
namespace {

using shader::Axis;
using shader::PackedProgram;
using shader::PackedVariant;

// A program beyond this has an axis that should be a specialisation constant.
constexpr std::size_t kMostVariants = 4096;

/// Findings of the whole technique, reported together, each once.
class Findings {
 public:
  void add(const std::string& text) {
    const std::lock_guard lock(mutex_);
    if (std::find(texts_.begin(), texts_.end(), text) == texts_.end()) texts_.push_back(text);
  }
  void throwIfAny() {
    if (texts_.empty()) return;
    std::sort(texts_.begin(), texts_.end());
    throw Error(fmt::format("{}", fmt::join(texts_, "\n")));
  }

 private:
  std::mutex mutex_;
  std::vector<std::string> texts_;
};

/// One stage to compile; several variants may share it.
struct Job {
  StageSource source;
  ContentHash key;
  Artifact artifact;
  bool reused = false;
};

struct ProgramStage {
  gpu::Stage stage;
  ExpandedSource source;
};

struct ProgramPlan {
  std::string name;
  std::vector<ProgramStage> stages;
  std::vector<Axis> axes;
  std::vector<Constraint> constraints;
  std::size_t possible = 1;
  struct Variant {
    std::vector<int> values;
    std::vector<Job*> jobs;  // per stage
  };
  std::vector<Variant> variants;
};

std::map<std::string, std::map<gpu::Stage, std::filesystem::path>> entryFiles(
    const std::filesystem::path& folder) {
  static const std::map<std::string, gpu::Stage> kStages{{".vert", gpu::Stage::vertex},
                                                         {".geom", gpu::Stage::geometry},
                                                         {".frag", gpu::Stage::fragment},
                                                         {".comp", gpu::Stage::compute}};
  if (!std::filesystem::is_directory(folder))
    throw Error(fmt::format("{}: no such folder of shaders", folder.string()));
  std::map<std::string, std::map<gpu::Stage, std::filesystem::path>> entries;
  // Subfolders only sort the files for readers: a program is named by its file's stem alone.
  std::set<std::filesystem::path> files;
  for (const auto& file : std::filesystem::recursive_directory_iterator(folder)) files.insert(file.path());
  for (const std::filesystem::path& file : files) {
    const auto stage = kStages.find(file.extension().string());
    if (stage == kStages.end()) continue;
    const std::string stem = file.stem().string();
    const bool nameable =
        !stem.empty() &&
        stem.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos &&
        stem[0] >= 'a';
    if (!nameable)
      throw Error(
          fmt::format("{}: error: expected a snake_case name, which becomes a C++ namespace", file.string()));
    std::map<gpu::Stage, std::filesystem::path>& stages = entries[stem];
    if (!stages.empty() && stages.begin()->second.parent_path() != file.parent_path())
      throw Error(fmt::format("{}: error: the program {} has a file in another folder, {}", file.string(),
                              stem, stages.begin()->second.string()));
    stages[stage->second] = file;
  }
  if (entries.empty())
    throw Error(fmt::format("{}: no entry files (*.vert, *.geom, *.frag, *.comp)", folder.string()));
  for (const auto& [stem, stages] : entries) {
    const std::string where = (stages.begin()->second.parent_path() / stem).string();
    if (stages.contains(gpu::Stage::compute) && stages.size() > 1) {
      throw Error(fmt::format(
          "{}.comp: error: a program is either a compute shader or raster stages of one name", where));
    }
    if (!stages.contains(gpu::Stage::compute) && !stages.contains(gpu::Stage::vertex)) {
      throw Error(fmt::format("{}: error: a raster program needs a vertex stage, {}.vert",
                              stages.begin()->second.string(), where));
    }
  }
  return entries;
}

void collectAxes(ProgramPlan& plan) {
  std::vector<AxisDeclaration> known;
  for (const ProgramStage& stage : plan.stages) {
    for (const AxisDeclaration& declaration : stage.source.axes) {
      const auto same = std::find_if(known.begin(), known.end(),
                                     [&](const auto& k) { return k.axis.name == declaration.axis.name; });
      if (same == known.end()) {
        known.push_back(declaration);
      } else if (same->axis.values != declaration.axis.values) {
        throw Error(fmt::format("{}: error: axis {} has other values at {}", declaration.place.text(),
                                declaration.axis.name, same->place.text()));
      }
    }
  }
  for (const AxisDeclaration& declaration : known) {
    plan.axes.push_back(declaration.axis);
    if (plan.possible > kMostVariants / declaration.axis.values.size()) {
      throw Error(fmt::format(
          "{}: error: program {} has more than {} combinations; what changes only a value should be a "
          "specialisation constant",
          declaration.place.text(), plan.name, kMostVariants));
    }
    plan.possible *= declaration.axis.values.size();
  }
  for (const ProgramStage& stage : plan.stages) {
    for (const Requirement& requirement : stage.source.requirements)
      plan.constraints.push_back(parseConstraint(requirement, plan.axes));
  }
}

/// All combinations of axis values, the last axis fastest, without those that a constraint excludes.
void enumerateVariants(ProgramPlan& plan) {
  for (std::size_t number = 0; number < plan.possible; ++number) {
    ProgramPlan::Variant variant;
    std::size_t rest = number;
    for (auto axis = plan.axes.rbegin(); axis != plan.axes.rend(); ++axis) {
      variant.values.insert(variant.values.begin(), axis->value(rest % axis->values.size()));
      rest /= axis->values.size();
    }
    const bool allowed = std::all_of(plan.constraints.begin(), plan.constraints.end(),
                                     [&](const auto& c) { return c(variant.values); });
    if (allowed) plan.variants.push_back(std::move(variant));
  }
  if (plan.variants.empty()) {
    throw Error(fmt::format("{}: error: the constraints exclude every variant",
                            plan.stages[0].source.entry.string()));
  }
}

/// The stage with macros for the axes that it mentions. A stage that does not mention an axis is compiled
/// once for all values of that axis.
StageSource stageSource(const ProgramPlan& plan, const ProgramStage& stage, const std::vector<int>& values) {
  StageSource source{&stage.source, stage.stage, {}, {}};
  for (std::size_t i = 0; i < plan.axes.size(); ++i) {
    const Axis& axis = plan.axes[i];
    if (stage.source.text.find(axis.name) == std::string::npos) continue;
    source.definitions += fmt::format("#define {} {}\n", axis.name, values[i]);
    source.variant +=
        fmt::format("{}{}={}", source.variant.empty() ? "" : " ", axis.name, axis.text(values[i]));
    if (!axis.named) continue;
    for (std::size_t v = 0; v < axis.values.size(); ++v) {
      source.definitions += fmt::format("#define {} {}\n", wordMacro(axis.name, axis.values[v]), v);
    }
  }
  return source;
}

std::filesystem::path cacheFile(const BuildOptions& options, const ContentHash& key) {
  return options.cache / options.technique / (key.text() + ".stage");
}

bool loadFromCache(const BuildOptions& options, Job& job) {
  const std::filesystem::path file = cacheFile(options, job.key);
  if (!std::filesystem::is_regular_file(file)) return false;
  std::optional<Artifact> artifact = deserialise(readFile(file));
  if (!artifact) return false;  // damaged: compiled anew and overwritten
  job.artifact = std::move(*artifact);
  job.reused = true;
  // Marks it as in use, see forgetOldArtifacts.
  std::error_code ignored;
  std::filesystem::last_write_time(file, std::filesystem::file_time_type::clock::now(), ignored);
  return true;
}

void runJobs(const BuildOptions& options, std::vector<std::unique_ptr<Job>>& jobs, Findings& findings) {
  startCompiler();
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < jobs.size(); i = next++) {
      Job& job = *jobs[i];
      try {
        if (loadFromCache(options, job)) continue;
        job.artifact = compileStage(job.source);
        writeFileAtomically(cacheFile(options, job.key), serialise(job.artifact));
      } catch (const Error& error) {
        findings.add(error.what());
      }
    }
  };
  const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
  const std::size_t count = std::min<std::size_t>(options.threads > 0 ? options.threads : cores, jobs.size());
  std::vector<std::jthread> threads;
  for (std::size_t i = 1; i < count; ++i) threads.emplace_back(work);
  work();
}

/// Removes cached artifacts that no build has used for a month.
void forgetOldArtifacts(const BuildOptions& options) {
  constexpr auto kKept = std::chrono::hours(24 * 30);
  std::error_code ignored;
  for (const auto& file : std::filesystem::directory_iterator(options.cache / options.technique, ignored)) {
    const auto age = std::filesystem::file_time_type::clock::now() - file.last_write_time(ignored);
    if (file.path().extension() == ".stage" && age > kKept) std::filesystem::remove(file.path(), ignored);
  }
}

std::string errorAt(const Job& job, const std::string& identifier, const std::string& what) {
  return fmt::format("{}: error: {}", job.source.source->placeOf(identifier).text(), what);
}

/// Collects the declarations of the stages of all variants, and reports contradictions among them.
class Merger {
 public:
  Merger(const ProgramPlan& plan, PackedProgram& program, ProgramInterface& interface, Findings& findings)
      : plan_(plan), program_(program), interface_(interface), findings_(findings) {}

  void run() {
    for (const ProgramPlan::Variant& variant : plan_.variants) {
      PackedVariant packed{variant.values, {}, {}};
      for (const Job* job : variant.jobs) {
        for (std::size_t i = 0; i < job->artifact.bindings.size(); ++i) {
          const std::uint32_t index = binding(*job, job->artifact.bindings[i], job->artifact.layouts[i]);
          interface_.elementBytes[job->artifact.bindings[i].name] = job->artifact.elementBytes[i];
          auto& used = packed.bindingsUsed;
          if (job->artifact.used[i] != 0 && std::find(used.begin(), used.end(), index) == used.end())
            used.push_back(index);
        }
        for (const StructLayout& layout : job->artifact.structs) structure(*job, layout);
        for (const shader::PackedConstant& constant : job->artifact.constants) this->constant(*job, constant);
        groupSize(job->artifact.groupSize);
      }
      std::sort(packed.bindingsUsed.begin(), packed.bindingsUsed.end());
      sharedBindings(variant, packed);
      stageInterfaces(variant);
      program_.variants.push_back(std::move(packed));
    }
    if (!sameGroupSize_) interface_.groupSize.clear();
  }

 private:
  std::uint32_t binding(const Job& job, const shader::PackedBinding& declared, const std::string& layout) {
    for (std::uint32_t i = 0; i < program_.bindings.size(); ++i) {
      shader::PackedBinding& known = program_.bindings[i];
      if (known.name != declared.name) continue;
      const auto describe = [](const shader::PackedBinding& b) {
        return fmt::format("{} {} ({})", name(b.kind), b.binding, b.type);
      };
      if (known.kind != declared.kind || known.binding != declared.binding ||
          known.textureKind != declared.textureKind || known.shadow != declared.shadow) {
        findings_.add(errorAt(job, declared.name,
                              fmt::format("'{}' is {} here, but {} in another stage or variant of program {}",
                                          declared.name, describe(declared), describe(known), plan_.name)));
      } else if (layouts_[i] != layout) {
        findings_.add(errorAt(job, declared.name,
                              fmt::format("'{}' has another layout in another stage or variant of program {}",
                                          declared.name, plan_.name)));
      } else if (known.type != declared.type) {
        continue;  // the format of a texture may follow an axis; every format is a binding of its own under
                   // the one name
      }
      known.minimumBytes = std::max(known.minimumBytes, declared.minimumBytes);
      return i;
    }
    program_.bindings.push_back(declared);
    layouts_.push_back(layout);
    return static_cast<std::uint32_t>(program_.bindings.size() - 1);
  }

  void structure(const Job& job, const StructLayout& layout) {
    for (const StructLayout& known : interface_.structs) {
      if (known.name != layout.name) continue;
      if (known == layout) return;
      return findings_.add(
          errorAt(job, layout.name,
                  fmt::format("'{}' has another layout in another stage or variant of program {}",
                              layout.name, plan_.name)));
    }
    interface_.structs.push_back(layout);
  }

  void constant(const Job& job, const shader::PackedConstant& declared) {
    for (const shader::PackedConstant& known : program_.constants) {
      if (known.name != declared.name && known.id != declared.id) continue;
      const bool same = known.name == declared.name && known.id == declared.id &&
                        known.type == declared.type && known.defaultBits == declared.defaultBits;
      if (!same) {
        findings_.add(errorAt(
            job, declared.name,
            fmt::format(
                "specialisation constant '{}' (id {}) has another name, id, type or default in another "
                "stage or variant of program {}, where '{}' has id {}",
                declared.name, declared.id, plan_.name, known.name, known.id)));
      }
      return;
    }
    program_.constants.push_back(declared);
  }

  void groupSize(const std::vector<std::uint32_t>& size) {
    if (size.empty()) return;
    if (interface_.groupSize.empty()) interface_.groupSize = size;
    sameGroupSize_ = sameGroupSize_ && interface_.groupSize == size &&
                     std::find(size.begin(), size.end(), 0u) == size.end();
  }

  void sharedBindings(const ProgramPlan::Variant& variant, const PackedVariant& packed) {
    for (const std::uint32_t a : packed.bindingsUsed) {
      for (const std::uint32_t b : packed.bindingsUsed) {
        const auto &first = program_.bindings[a], &second = program_.bindings[b];
        if (a >= b || first.kind != second.kind || first.binding != second.binding) continue;
        findings_.add(errorAt(*variant.jobs.back(), second.name,
                              fmt::format("'{}' and '{}' are both {} {} of program {}", first.name,
                                          second.name, name(first.kind), first.binding, plan_.name)));
      }
    }
  }

  /// Every input of a stage must be an output of the stage before it.
  void stageInterfaces(const ProgramPlan::Variant& variant) {
    for (std::size_t i = 1; i < variant.jobs.size(); ++i) {
      const Artifact& before = variant.jobs[i - 1]->artifact;
      for (const StageVariable& input : variant.jobs[i]->artifact.inputs) {
        const auto output = std::find_if(
            before.outputs.begin(), before.outputs.end(),
            [&](const StageVariable& candidate) { return candidate.location == input.location; });
        const std::string where = plan_.stages[i - 1].source.entry.filename().string();
        if (output == before.outputs.end()) {
          findings_.add(errorAt(*variant.jobs[i], input.name,
                                fmt::format("input '{}' at location {} is not written by {}", input.name,
                                            input.location, where)));
        } else if (output->type != input.type) {
          findings_.add(errorAt(
              *variant.jobs[i], input.name,
              fmt::format("input '{}' at location {} is a {}, but {} writes a {} ('{}') there", input.name,
                          input.location, input.type, where, output->type, output->name)));
        }
      }
    }
  }

  const ProgramPlan& plan_;
  PackedProgram& program_;
  ProgramInterface& interface_;
  Findings& findings_;
  std::vector<std::string> layouts_;  // per binding of the program
  bool sameGroupSize_ = true;
};

/// Each distinct SPIR-V module once, in the order of the programs. The artifacts must outlive it.
class CodeTable {
 public:
  std::size_t add(const Artifact& artifact) {
    const ContentHash hash = Hasher().add(artifact.spirv).finish();
    const auto [known, isNew] = index_.emplace(hash, codes_.size());
    if (isNew) codes_.push_back({hash, artifact.spirv});
    return known->second;
  }
  std::vector<shader::PackedCode> compressed() const { return shader::compressed(codes_); }

 private:
  std::vector<shader::PlainCode> codes_;
  std::map<ContentHash, std::size_t> index_;
};

}  // namespace

BuildResult buildPack(const BuildOptions& options) {
  BuildResult result;
  result.pack.technique = options.technique;
  Findings findings;
  std::vector<std::unique_ptr<ProgramPlan>> plans;  // jobs point into them
  for (const auto& [stem, files] : entryFiles(options.source)) {
    auto plan = std::make_unique<ProgramPlan>();
    plan->name = stem;
    try {
      for (const auto& [stage, file] : files) {
        plan->stages.push_back({stage, expandSource(file, options.includes)});
        result.files.insert(plan->stages.back().source.files.begin(), plan->stages.back().source.files.end());
      }
      collectAxes(*plan);
      enumerateVariants(*plan);
      plans.push_back(std::move(plan));
    } catch (const Error& error) {
      findings.add(error.what());
    }
  }

  std::filesystem::create_directories(options.cache / options.technique);
  std::vector<std::unique_ptr<Job>> jobs;
  std::map<ContentHash, Job*> known;
  for (const auto& plan : plans) {
    for (auto& variant : plan->variants) {
      for (const ProgramStage& stage : plan->stages) {
        auto job = std::make_unique<Job>();
        job->source = stageSource(*plan, stage, variant.values);
        job->key = job->source.key();
        const auto [found, isNew] = known.emplace(job->key, job.get());
        variant.jobs.push_back(found->second);
        if (isNew) jobs.push_back(std::move(job));
      }
    }
  }
  runJobs(options, jobs, findings);
  findings.throwIfAny();

  CodeTable codes;
  for (const auto& plan : plans) {
    PackedProgram& program = result.pack.programs.emplace_back();
    program.name = plan->name;
    program.axes = plan->axes;
    program.possible = plan->possible;
    Merger(*plan, program, result.interfaces[plan->name], findings).run();
    for (std::size_t v = 0; v < plan->variants.size(); ++v) {
      for (std::size_t s = 0; s < plan->stages.size(); ++s) {
        program.variants[v].stages.push_back(
            {plan->stages[s].stage, codes.add(plan->variants[v].jobs[s]->artifact)});
      }
    }
  }
  findings.throwIfAny();
  result.pack.codes = codes.compressed();
  for (const auto& job : jobs) {
    ++(job->reused ? result.reused : result.compiled);
    if (!job->artifact.warnings.empty()) result.warnings += job->artifact.warnings + "\n";
  }
  forgetOldArtifacts(options);
  return result;
}

}  // namespace lumivox::shaderpack
