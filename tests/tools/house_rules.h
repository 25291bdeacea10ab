// The rules of the house over sources as texts, so that bad examples can be given to them as well: each
// returns its violations, "file:line: what".
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

namespace lumivox::test::house {

struct SourceFile {
  std::string path;  ///< relative to the project, with forward slashes
  std::string text;
};
using Sources = std::vector<SourceFile>;
using Violations = std::vector<std::string>;

bool startsWith(const std::string& text, const std::string& start);
bool endsWith(const std::string& text, const std::string& end);

/// Blanks comments, and string literals too when asked; keeps lines, so that line numbers stay right.
enum class Strings { keep, blank };
std::string withoutComments(const std::string& text, Strings strings);
int lineOf(const std::string& text, std::size_t position);

struct Include {
  int line;
  std::string path;
};
std::vector<Include> includesOf(const std::string& text);

/// The order in which parts may include each other, and the same of the build's list of parts.
Violations brokenIncludeOrder(const Sources& sources);
Violations brokenBuildOrder(const std::string& listFile);

/// What may be used in its homes alone.
struct Confined {
  const char* what;
  const char* pattern;
  std::vector<std::string> homes;  ///< path prefixes
};
extern const Confined kOpenGl, kEmbree, kOpenVdb, kSqlite;
Violations escaped(const Sources& sources, const Confined& rule);
Violations markup(const Sources& sources);
Violations boundAnalysis(const Sources& sources);

Violations namedTechniques(const Sources& sources, const std::vector<std::string>& techniques);
Violations dependentTechniques(const Sources& sources, const std::vector<std::string>& techniques);
/// One name everywhere: `files` are all of the project, `pipelines` those that are committed.
Violations brokenNames(const std::set<std::string>& files, const std::vector<std::string>& techniques,
                       const Sources& pipelines);

/// How much one sits down to read: C++ files of a folder of a technique and their lines, each folder by
/// itself.
struct FolderSize {
  int files = 0, lines = 0;
};
constexpr FolderSize kLargestFolder{12, 1300};
/// Files that a program's stage may include, those that included files include counted too.
constexpr int kMostIncluded = 10;
/// Folders that are larger. `exceptions`: by path, with the size that they may have at most; one that is not
/// needed is a violation.
Violations largeFolders(const Sources& sources, const std::map<std::string, FolderSize>& exceptions);
/// The same for entry files of shaders.
Violations widelyIncluding(const Sources& sources, const std::map<std::string, int>& exceptions);

/// A kind of port, and members that its readers must heed (PortKind::conditions).
struct HeededKind {
  std::string name;
  std::set<std::string> members;
};
/// Inputs of techniques, examples and templates whose pass never looks at one of these members. `passedOn`:
/// "file: input" of those whose output keeps the members as they are; one that is not needed is a violation.
Violations unheededMembers(const Sources& sources, const std::vector<HeededKind>& kinds,
                           const std::set<std::string>& passedOn);
/// Members that the struct of their kind does not have.
Violations unknownMembers(const Sources& sources, const std::vector<HeededKind>& kinds);
Violations unfinished(const Sources& sources);
Violations namespacesUsedInHeaders(const Sources& sources);

}  // namespace lumivox::test::house
