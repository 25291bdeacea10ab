// Errors of input: everything that a user can cause. A bug is an assertion; an expected absence is an
// optional.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace lumivox {

/// A place in a text file. Lines and columns count from 1; 0 means that the place is the file as a whole.
struct SourcePlace {
  std::string file;
  int line = 0;
  int column = 0;

  /// "file:line:column", shortened where line or column are unknown.
  std::string text() const;
};

/// One finding in an input file: what is wrong there, what would have been right, and the nearest known word.
struct Diagnostic {
  enum class Severity { error, warning };

  Severity severity = Severity::error;
  SourcePlace place;
  std::string what;        ///< e.g. "unknown property 'fow'"
  std::string expected;    ///< e.g. "one of eye, target, up, fov, resolution"; may be empty
  std::string suggestion;  ///< e.g. "fov"; may be empty
  std::string sourceLine;  ///< the line that holds the place, without its end; may be empty
  int length = 1;          ///< how many columns the caret line marks

  /// `file:line:column: what; expected ...; did you mean '...'?` followed by the source line and a caret
  /// line.
  std::string text() const;
};

/// Bad input. The message names the file or object, what is wrong and what was expected. The command line
/// turns it into exit code 2.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The number of findings shown at once; the number of the others is shown.
inline constexpr std::size_t kMostFindingsShown = 200;

/// How many of so many findings are shown: all, or the first kMostFindingsShown.
std::size_t shownFindings(std::size_t count);
/// "and 24800 more findings; ..." below the ones that are shown; empty where all are.
std::string moreFindingsText(std::size_t count);

/// All findings of one or more text files, reported together; the message shows the first ones
/// (shownFindings()), in the order of the text.
class DiagnosticsError : public Error {
 public:
  explicit DiagnosticsError(std::vector<Diagnostic> diagnostics);
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

/// Something that may be absent on a machine (a model, a GPU). Tests count it as skipped.
class AbsentError : public Error {
 public:
  using Error::Error;
};

/// "a, b, c"; of very many the first ones, and how many more there are.
std::string listed(const std::vector<std::string>& words);

/// The candidate nearest to `word` by edit distance; empty when none is near enough for a typing error.
std::string nearestWord(const std::string& word, const std::vector<std::string>& candidates);

/// nearestWord() for a further finding; empty if the finding will not be shown.
std::string suggestionFor(const std::vector<Diagnostic>& findings, const std::string& word,
                          const std::vector<std::string>& candidates);

}  // namespace lumivox
