#include "viewer/techniques.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/installation.h"
#include "viewer/program.h"

namespace lumivox::viewer {
namespace {

namespace fs = std::filesystem;

/// The folder of a technique's shaders in the source tree that its library was built in; empty if that is not
/// available.
fs::path shadersOf(const std::string& technique, const fs::path& library) {
  if (library.empty()) return {};
  const auto folder = programData(fs::path("shaders") / technique, library);
  return folder ? *folder : fs::path();
}

Compiled compiled(const CompileWish& wish, const std::atomic<bool>& stop) {
  Compiled result{wish, {}};
  try {
    const fs::path program = programBeside("shaderpack");
    const ProgramResult done =
        runProgram({program.string(), "--technique", wish.technique, "--source", wish.source.string(),
                    "--include", wish.includes.string(), wish.common.string(), "--cache", wish.cache.string(),
                    "--pack", wish.pack.string(), "--header", wish.header.string()},
                   &stop);
    if (done.exitCode != 0) result.error = done.errors.empty() ? "shaderpack failed" : done.errors;
  } catch (const std::exception& error) {
    result.error = error.what();
  }
  return result;
}

}  // namespace

LiveTechniques::LiveTechniques(std::vector<fs::path> directories, std::function<void()> wake)
    : given_(directories),
      directories_(std::move(directories)),
      compiler_(
          [] {
            return [](const CompileWish& wish, LatestWorker<CompileWish, Compiled>::Turn& turn) {
              turn.give(compiled(wish, turn.outdated()));
            };
          },
          std::move(wake)) {}

LiveTechniques::~LiveTechniques() {
  compiler_.stop();
}

fs::path LiveTechniques::libraryOf(const std::string& technique) const {
  for (const fs::path& directory : given_) {
    const fs::path library = directory / ("lib" + technique + ".so");
    std::error_code ignored;
    if (fs::exists(library, ignored)) return library;
  }
  return {};
}

void LiveTechniques::use(const std::set<std::string>& techniques) {
  used_ = techniques;
  files_.clear();
  for (const std::string& technique : techniques) {
    if (const fs::path library = libraryOf(technique); !library.empty()) {
      files_[library] = {technique, false};
      files_[library.parent_path() / (technique + ".shaderpack")] = {technique, false};
    }
    const fs::path shaders = shadersOf(technique, libraryOf(technique));
    if (shaders.empty()) continue;
    std::error_code ignored;
    for (const fs::path& folder :
         {shaders, shaders.parent_path() / "common", shaders.parent_path() / "toolkit"})
      for (const fs::directory_entry& file : fs::recursive_directory_iterator(folder, ignored))
        if (file.is_regular_file(ignored)) files_.emplace(file.path(), std::pair(technique, true));
  }
  std::set<fs::path> names;
  for (const auto& [file, what] : files_) names.insert(file);
  watch_.set(names);
}

void LiveTechniques::stage(const std::string& technique, const fs::path& pack) {
  dropLost();
  const fs::path folder = folder_.path() / fmt::format("{}_{}", technique, ++stages_);
  fs::create_directories(folder);
  const fs::path library = libraryOf(technique);
  fs::copy_file(library, folder / library.filename());
  if (fs::exists(pack)) fs::copy_file(pack, folder / (technique + ".shaderpack"));
  // Replaces the folder that was staged before.
  fs::path& last = staged_[technique];
  std::erase(directories_, last);
  last = folder;
  directories_.insert(directories_.begin(), folder);
  errors_.erase(technique);
}

bool LiveTechniques::dropLost() {
  if (staged_.empty() || folder_.isSound()) return false;
  // Another user may have put libraries into a folder of the same name.
  for (const auto& [technique, folder] : staged_) {
    std::erase(directories_, folder);
    errors_[technique] = fmt::format(
        "{} is gone, or no longer this user's alone: {} is shown as it was built; save it again to see its "
        "changes",
        folder.parent_path().string(), technique);
  }
  staged_.clear();
  return true;
}

void LiveTechniques::compile(const std::string& technique) {
  const fs::path source = shadersOf(technique, libraryOf(technique));
  const auto common = programData("shaders");
  // Shares the build's cache of compiled shaders.
  const fs::path built = libraryOf(technique).parent_path().parent_path().parent_path() / "shadercache";
  const fs::path cache = fs::is_directory(built) ? built : cacheDirectory() / "viewer_shaders";
  const fs::path folder = folder_.path() / "compiled";
  fs::create_directories(folder);
  compiler_.want({technique, source, source.parent_path(), common.value_or(source.parent_path()), cache,
                  folder / (technique + ".shaderpack"), folder / (technique + "_shaders.h")});
}

void LiveTechniques::changed(const std::string& technique, bool shaders) {
  try {
    if (shaders) {
      waiting_.insert(technique);
    } else {
      const fs::path library = libraryOf(technique);
      stage(technique, library.parent_path() / (technique + ".shaderpack"));
    }
  } catch (const std::exception& error) {
    errors_[technique] = error.what();
  }
}

bool LiveTechniques::update() {
  bool news = dropLost();
  std::map<std::string, bool> which;  // true: only shaders changed
  for (const fs::path& file : watch_.changed()) {
    const auto& [technique, shader] = files_.at(file);
    // A change to shared shaders concerns every technique.
    const fs::path below = file.lexically_relative(shadersOf(technique, libraryOf(technique)).parent_path());
    const bool shared =
        shader && !below.empty() && (*below.begin() == "common" || *below.begin() == "toolkit");
    for (const std::string& one : shared ? used_ : std::set<std::string>{technique}) {
      const auto known = which.emplace(one, shader).first;
      known->second = known->second && shader;
    }
  }
  for (const auto& [technique, shader] : which) {
    changed(technique, shader);
    news = true;
  }
  if (const auto done = compiler_.take()) {
    news = true;
    if (done->error.empty()) {
      try {
        stage(done->wish.technique, done->wish.pack);
      } catch (const std::exception& error) {
        errors_[done->wish.technique] = error.what();
      }
    } else {
      errors_[done->wish.technique] = done->error;
    }
  }
  if (!waiting_.empty() && !compiler_.busy()) {
    const std::string technique = *waiting_.begin();
    waiting_.erase(waiting_.begin());
    try {
      compile(technique);
    } catch (const std::exception& error) {  // such as a folder that cannot be made
      errors_[technique] = error.what();
      news = true;
    }
  }
  return news;
}

void LiveTechniques::reload() {
  for (const std::string& technique : used_) changed(technique, false);
}

}  // namespace lumivox::viewer
