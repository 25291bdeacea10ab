#include "new_technique.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"

namespace lumivox::command {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestName = 64;

/// Keywords of C++, and names of the framework's namespaces and shader folders, which a technique of that
/// name would hide.
const std::set<std::string>& reservedWords() {
  static const std::set<std::string> words = {
      // clang-format off
      "alignas", "alignof", "and", "and_eq", "asm", "auto", "bitand", "bitor", "bool", "break", "case", "catch",
      "char", "char8_t", "char16_t", "char32_t", "class", "co_await", "co_return", "co_yield", "compl", "concept",
      "const", "const_cast", "consteval", "constexpr", "constinit", "continue", "decltype", "default", "delete",
      "do", "double", "dynamic_cast", "else", "enum", "explicit", "export", "extern", "false", "float", "for",
      "friend", "goto", "if", "inline", "int", "long", "mutable", "namespace", "new", "noexcept", "not", "not_eq",
      "nullptr", "operator", "or", "or_eq", "private", "protected", "public", "register", "reinterpret_cast",
      "requires", "return", "short", "signed", "sizeof", "static", "static_assert", "static_cast", "struct",
      "switch", "template", "this", "thread_local", "throw", "true", "try", "typedef", "typeid", "typename",
      "union", "unsigned", "using", "virtual", "void", "volatile", "wchar_t", "while", "xor", "xor_eq",
      "command", "common", "device", "dsl", "gpu", "lumivox", "report", "shader", "shaders", "std", "test",
      "toolkit", "viewer"
      // clang-format on
  };
  return words;
}

std::string withName(std::string text, const std::string& name) {
  const std::string nameInTemplates = kNameInTemplates;
  for (std::size_t at = text.find(nameInTemplates); at != std::string::npos;
       at = text.find(nameInTemplates, at + name.size()))
    text.replace(at, nameInTemplates.size(), name);
  return text;
}

/// Adds the files of a template folder by their new paths. The technique's name replaces kNameInTemplates in
/// paths and texts; images are copied.
void addTemplates(std::map<fs::path, std::string>& files, const fs::path& folder, const std::string& name) {
  if (!fs::is_directory(folder))
    throw Error(
        fmt::format("{}: no such folder; the templates of a technique belong there", folder.string()));
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    const std::string content = readFile(entry.path());
    const fs::path relative = entry.path().lexically_relative(folder);
    files.emplace(withName(relative.generic_string(), name),
                  relative.extension() == ".png" ? content : withName(content, name));
  }
}

}  // namespace

std::string nameDefect(const std::string& name) {
  const auto fits = [](unsigned char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  if (name.empty() || name.size() > kLongestName || !std::all_of(name.begin(), name.end(), fits) ||
      name.front() < 'a' || name.back() == '_' || name.find("__") != std::string::npos)
    return fmt::format(
        "'{}' is not a name for a technique; expected at most {} small letters, digits and single underscores "
        "that begin with a letter and end with a letter or digit, such as my_paper",
        name, kLongestName);
  if (reservedWords().count(name) != 0)
    return fmt::format(
        "'{}' is a word of C++ or of the framework; expected a name that becomes a C++ namespace, such as my_paper",
        name);
  return {};
}

bool isTechniqueProject(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_regular_file(folder / "CMakeLists.txt", ignored) &&
         fs::is_directory(folder / "techniques", ignored);
}

std::vector<fs::path> newTechnique(const fs::path& templates, const std::string& name,
                                   const fs::path& project) {
  if (const std::string defect = nameDefect(name); !defect.empty()) throw Error(defect);
  std::map<fs::path, std::string> files;
  addTemplates(files, templates / "technique", name);
  std::error_code ignored;
  if (!isTechniqueProject(project)) {
    const bool isEmpty = fs::is_directory(project, ignored) && fs::is_empty(project, ignored);
    if (fs::exists(fs::symlink_status(project, ignored)) && !isEmpty)
      throw Error(fmt::format(
          "{}: exists and is not a project with techniques; expected a new or empty folder, or one with "
          "CMakeLists.txt and techniques/",
          project.string()));
    addTemplates(files, templates / "project", name);
  }
  std::vector<fs::path> taken = {fs::path("techniques") / name, fs::path("shaders") / name};
  for (const auto& [file, content] : files) taken.push_back(file);
  for (const fs::path& path : taken)
    if (fs::exists(fs::symlink_status(project / path, ignored)))
      throw Error(fmt::format("{}: exists already; expected a name that is not taken, or remove it first",
                              (project / path).string()));
  std::vector<fs::path> written;
  for (const auto& [file, content] : files) {
    createParentDirectories(project / file);
    writeFileAtomically(project / file, content);
    written.push_back(file);
  }
  return written;
}

}  // namespace lumivox::command
