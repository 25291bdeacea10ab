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

/// A command as it stands in the guide, and what it said.
struct Followed {
  std::string command;
  CommandResult result;
};

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
  /// Whether the sentence still stands in the guide, whatever its line breaks: what follows holds it against
  /// what happened.
  bool says(const std::string& sentence) const;
  bool has(const std::string& file) const;
  std::filesystem::path file(const std::string& name) const { return folder() / name; }
  std::filesystem::path folder() const { return home_.path() / "tree"; }
  std::size_t omitted() const { return omitted_; }
  /// The commands that ended badly, but for those that contain one of `expected`.
  std::string failures(const std::vector<std::string>& expected = {}) const;
  /// What git would show as new or changed; empty also where there is no git.
  std::string leftovers() const;

 private:
  void follow(const std::vector<std::string>& commands);
  std::string environment() const;

  TemporaryDirectory home_;
  std::string text_, path_;
  std::vector<Followed> commands_;
  std::size_t omitted_ = 0;
};

}  // namespace lumivox::test
