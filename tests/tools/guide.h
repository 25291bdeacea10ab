// The guides as texts, and guides that are followed: every command of one, in its order, in a copy of the
// tree.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "support/support.h"

namespace lumivox::test {

/// A fenced block of a Markdown text.
struct Quote {
  std::string language, text;
  int line = 0;
};
std::vector<Quote> quotesOf(const std::string& markdown);

/// README.md, CONTRIBUTING.md, CHANGELOG.md, docs/*.md, and what the folders of the house say of themselves:
/// their README.md, but for the paper cards.
std::vector<std::filesystem::path> guides();

/// The lines of all blocks of shell commands, without their comments.
std::vector<std::string> commandLinesOf(const std::string& markdown);

/// A command that `code` in a sentence shows or names: `lumivox render --health`, say. Options that it names;
/// words in capitals stand for something.
struct NamedCommand {
  std::string program;               ///< lumivox or vdbexport
  std::string command;               ///< empty of vdbexport
  std::vector<std::string> options;  ///< with their dashes
};
std::vector<NamedCommand> namedCommandsOf(const std::string& markdown);

/// A command that no test runs as it stands in the guides: `pattern` is a regular expression.
struct Omission {
  const char* pattern;
  const char* needs;  ///< a shell command that ends well where it can be run; empty: nowhere
  const char* reason;
};
const std::vector<Omission>& omissions();

/// What makes commands small: a regular expression and what takes its place. In the order of the list.
struct Reduction {
  const char* pattern;
  const char* by;
};
const std::vector<Reduction>& reductions();
std::string reduced(std::string command);

/// A comment of a guide, `<!-- checked: VERB ... -->`, that says what the last command before it has done;
/// with `checked [PART]` the last one that contains PART. The sentences around it may change:
///   runs COMMAND         is a command that readers do not see, in its place among the others
///   prints A ; B         it wrote a match of each of these regular expressions, to either stream
///   lacks A ; B          it wrote none of these
///   ends with A          the last line that it printed matches
///   exits 1              in place of 0; `exits 1 if it prints A`: where it does, else 0
///   writes FILE FILE     files and folders of the tree that are there at the end, not empty; `writes no
///   FILE` layers FILE A B      the layers that an EXR has at least
struct Mark {
  int line = 0;
  std::string verb, what;
};

/// A command of a guide, what it said, and the marks about it.
struct Step {
  int line = 0;
  std::string command;
  std::vector<Mark> marks;
  bool omitted = false;
  CommandResult result;
};
/// The commands of a guide with their marks. A mark that is none fails the test.
std::vector<Step> stepsOf(const std::string& markdown);

/// Which marks of a step do not hold in a folder, a line each: empty if all do. Without a mark `exits` the
/// step must have ended with 0.
std::string unheld(const Step& step, const std::filesystem::path& folder);

/// A guide whose commands have been run in a copy of the tree without build/, by a shell of its own, reduced
/// by the rules above. ./run, ./test and the set-up are the tree's own; ninja, cmake and ctest only say how
/// they were called, and what is built is used.
class FollowedGuide {
 public:
  explicit FollowedGuide(const std::string& name);
  /// The same with words of the guide replaced (PREFIX, say), from a folder of its own in place of the copy,
  /// with the tools themselves in place of what stands in for them.
  FollowedGuide(const std::string& name, const std::vector<std::pair<std::string, std::string>>& words,
                const std::vector<std::filesystem::path>& programs);

  /// The last command that contains this part.
  const CommandResult& of(const std::string& part) const;
  /// One more command in the same folder, with the same programs.
  CommandResult run(const std::string& command) const;
  bool has(const std::string& file) const;
  std::filesystem::path file(const std::string& name) const { return folder() / name; }
  std::filesystem::path folder() const { return home_.path() / "tree"; }
  std::size_t omitted() const;
  /// The commands that ended badly and the marks that do not hold, each with its line and what it printed.
  std::string failures() const;
  /// What git would show as new or changed; empty also where there is no git.
  std::string leftovers() const;

 private:
  void follow();
  std::string environment() const;

  TemporaryDirectory home_;
  std::string name_, path_;
  std::vector<Step> steps_;
};

}  // namespace lumivox::test
