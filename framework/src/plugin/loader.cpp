#include "lumivox/plugin/loader.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <set>
#include <sstream>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "lumivox/base/installation.h"
#include "lumivox/base/log.h"
#include "lumivox/plugin/technique.h"
#include "plugin/elf_check.h"

namespace lumivox {

namespace fs = std::filesystem;

namespace {

/// The reason why a library cannot be used.
class Unfit : public Error {
 public:
  using Error::Error;
};

class Registry : public TechniqueRegistry {
 public:
  explicit Registry(Technique& technique) : technique_(technique) {}
  void describe(std::string meaning, std::string paper) override {
    technique_.meaning = std::move(meaning);
    technique_.paper = std::move(paper);
  }
  void add(PassEntry entry) override {
    if (entry.name.empty() || !entry.make) throw Unfit("it registers a pass without a name or a factory");
    if (technique_.find(entry.name) != nullptr)
      throw Unfit(fmt::format("it registers the pass '{}' twice", entry.name));
    technique_.passes.push_back(std::move(entry));
  }

 private:
  Technique& technique_;
};

template <class Function>
Function* symbol(void* handle, const char* name) {
  void* address = dlsym(handle, name);
  if (address == nullptr) throw Unfit(fmt::format("the symbol {} is missing", name));
  return reinterpret_cast<Function*>(address);
}

/// Throws Unfit or another Error with the reason why it cannot be used.
std::unique_ptr<Technique> open(const std::string& name, const fs::path& library) {
  auto technique = std::make_unique<Technique>();
  technique->name = name;
  technique->library = library;
  const std::string bytes = readFile(library, kLargestLibraryFile);
  if (const std::string defect = sharedLibraryDefect(bytes); !defect.empty()) throw Unfit(defect);
  technique->hash = hashOf(bytes);

  // Read from the file, because opening a library runs its code and may bind the data of others to it.
  const std::optional<std::string_view> version = sectionOf(bytes, LUMIVOX_VERSION_SECTION);
  if (!version)
    throw Unfit("it has no version record (ELF section " LUMIVOX_VERSION_SECTION
                "): no technique library, or one for another Lumivox");
  if (const std::string difference = versionDifference(*version); !difference.empty())
    throw Unfit("built for another Lumivox: " + difference);
  fs::path pack = library.parent_path() / (name + ".shaderpack");
  if (fs::exists(pack)) {
    technique->shaders = shader::readShaderPack(pack);
    if (technique->shaders.technique != name) {
      throw Unfit(
          fmt::format("{} contains the shaders of '{}'", pack.string(), technique->shaders.technique));
    }
  }

  // The path contains a slash, so that the loader searches nowhere else. The handle stays open until the
  // program ends, because passes and their functions live in it.
  void* handle = dlopen(fs::absolute(library).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    const char* reason = dlerror();
    throw Unfit(reason != nullptr ? reason : "the dynamic loader refused it");
  }
  Registry registry(*technique);
  symbol<void(TechniqueRegistry*)>(handle, "lumivox_technique_register")(&registry);
  if (technique->passes.empty()) throw Unfit("it registers no pass");
  return technique;
}

/// A name of a folder and a library, never a path.
bool isTechniqueName(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(),
                                      [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
}

}  // namespace

struct TechniqueSet::State {
  std::vector<fs::path> directories;
  bool strict = false;
  std::map<std::string, std::unique_ptr<Technique>> opened;  ///< null: absent or skipped
  std::vector<SkippedTechnique> skipped;
};

TechniqueSet::TechniqueSet(std::vector<fs::path> directories, bool strict)
    : state_(new State{std::move(directories), strict, {}, {}}) {}
TechniqueSet::~TechniqueSet() = default;

std::vector<fs::path> TechniqueSet::defaultDirectories(const std::vector<fs::path>& given) {
  for (const fs::path& directory : given) {
    if (!fs::is_directory(directory))
      throw Error(directory.string() + ": no such directory; expected one with technique libraries");
  }
  std::vector<fs::path> directories = given;
  if (const char* variable = std::getenv("LUMIVOX_TECHNIQUES")) {
    std::istringstream stream(variable);
    for (std::string directory; std::getline(stream, directory, ':');) {
      if (!directory.empty()) directories.emplace_back(directory);
    }
  }
  directories.push_back(libraryFolder() / "techniques");
  return directories;
}

const Technique* TechniqueSet::technique(const std::string& name) {
  State& s = *state_;
  if (const auto known = s.opened.find(name); known != s.opened.end()) return known->second.get();
  std::unique_ptr<Technique>& slot = s.opened[name];
  if (!isTechniqueName(name)) return nullptr;
  for (const fs::path& directory : s.directories) {
    const fs::path library = directory / ("lib" + name + ".so");
    std::error_code ignored;
    if (!fs::exists(library, ignored)) continue;
    try {
      slot = open(name, library);
      return slot.get();
    } catch (const std::exception& error) {
      if (s.strict) {
        s.opened.erase(name);
        throw Error(fmt::format("{}: {}; refused under --strict", library.string(), error.what()));
      }
      s.skipped.push_back({library, error.what()});
      logWarning("skipped {}: {}", library.string(), error.what());
    }
  }
  return nullptr;
}

std::vector<std::string> TechniqueSet::available() const {
  std::set<std::string> names;
  for (const fs::path& directory : state_->directories) {
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(directory, ignored)) {
      const std::string file = entry.path().filename().string();
      if (file.size() <= 6 || file.rfind("lib", 0) != 0 || entry.path().extension() != ".so") continue;
      const std::string name = file.substr(3, file.size() - 6);
      if (isTechniqueName(name)) names.insert(name);
    }
  }
  return {names.begin(), names.end()};
}

const std::vector<SkippedTechnique>& TechniqueSet::skipped() const {
  return state_->skipped;
}

std::vector<fs::path> TechniqueSet::folders() const {
  return state_->directories;
}

std::vector<std::string> TechniqueSet::opened() const {
  std::vector<std::string> names;
  for (const auto& [name, technique] : state_->opened) {
    if (technique) names.push_back(name);
  }
  return names;
}

}  // namespace lumivox
