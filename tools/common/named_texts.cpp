#include "common/named_texts.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>

#include "lumivox/base/error.h"
#include "lumivox/base/installation.h"
#include "lumivox/experiment/report.h"

namespace lumivox::command {
namespace {

namespace fs = std::filesystem;

/// One kind of text: its word, its ending and its folder below `scenes`.
struct TextPlace {
  const char *word, *extension, *folder;
};
constexpr TextPlace kScenes{"scene", ".scene", ""}, kPipelines{"pipeline", ".pipeline", "pipelines"};

std::vector<TextPlace> placesOf(NamedText kind) {
  if (kind == NamedText::scene) return {kScenes};
  if (kind == NamedText::pipeline) return {kPipelines};
  return {kScenes, kPipelines};
}

/// The folder `scenes` of the project around the working folder, then the one installed with the program.
std::vector<fs::path> textFolders() {
  std::vector<fs::path> folders;
  std::error_code failure;
  for (const auto& scenes : {committedScenes(), programData("scenes")})
    if (scenes && std::none_of(folders.begin(), folders.end(), [&](const fs::path& known) {
          return fs::equivalent(known, *scenes, failure);
        }))
      folders.push_back(*scenes);
  return folders;
}

std::vector<fs::path> filesIn(const std::vector<fs::path>& folders, const TextPlace& place) {
  std::vector<fs::path> files;
  std::error_code failure;
  for (const fs::path& folder : folders)
    for (const fs::directory_entry& entry : fs::directory_iterator(folder / place.folder, failure))
      if (entry.path().extension() == place.extension && entry.is_regular_file())
        files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::optional<fs::path> fileNamed(const fs::path& name, const std::vector<fs::path>& folders,
                                  const TextPlace& place) {
  std::error_code failure;
  for (const fs::path& folder : folders) {
    const fs::path file = folder / place.folder / (name.string() + place.extension);
    if (!fs::is_regular_file(file, failure)) continue;
    const fs::path shown = fs::proximate(file, failure);
    return failure ? file : shown;
  }
  return std::nullopt;
}

bool isPath(const fs::path& given) {
  std::error_code failure;
  if (given.empty() || given.is_absolute() || given.has_extension()) return true;
  if (*given.begin() == "." || *given.begin() == ".." || !given.has_filename()) return true;
  return fs::exists(given, failure);
}

}  // namespace

std::vector<fs::path> listedTexts(NamedText kind) {
  const std::vector<fs::path> folders = textFolders();
  if (folders.empty())
    throw AbsentError(
        "no project here: no folder scenes/pipelines in this folder or above, nor beside the program");
  std::vector<fs::path> files;
  for (const TextPlace& place : placesOf(kind)) {
    const std::vector<fs::path> some = filesIn(folders, place);
    files.insert(files.end(), some.begin(), some.end());
  }
  return files;
}

fs::path textOf(const fs::path& given, NamedText kind) {
  if (isPath(given)) return given;
  const std::vector<fs::path> folders = textFolders();
  const std::vector<TextPlace> places = placesOf(kind);
  for (const TextPlace& place : places)
    if (const auto file = fileNamed(given, folders, place)) return *file;
  std::vector<std::string> known;
  std::string words, lists;
  for (const TextPlace& place : places) {
    words += (words.empty() ? "" : " or ") + std::string(place.word);
    lists += fmt::format("{}`lumivox list {}s`", lists.empty() ? "" : " or ", place.word);
    for (const fs::path& file : filesIn(folders, place)) known.push_back(file.stem().string());
  }
  for (const TextPlace& other : {kScenes, kPipelines})
    if (kind != NamedText::sceneOrPipeline && other.word != words && fileNamed(given, folders, other))
      throw Error(fmt::format("'{}' is a {}; expected a {}", given.string(), other.word, words));
  const std::string nearest = nearestWord(given.string(), known);
  throw Error(fmt::format("no {} is called '{}', and no file; expected a text, or a name as {} prints it{}",
                          words, given.string(), lists,
                          nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
}

CLI::Option* takesNames(CLI::Option* option, NamedText kind) {
  return option->transform(CLI::Validator(
      [kind](std::string& given) {
        try {
          given = textOf(given, kind).string();
        } catch (const Error& error) {
          return std::string(error.what());
        }
        return std::string();
      },
      ""));
}

}  // namespace lumivox::command
