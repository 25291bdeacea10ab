// The files that a command writes, checked before its work.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lumivox::command {

/// The files that a command is about to write. Every Error names the option.
class Outputs {
 public:
  /// otherKindsRefused: refuses the endings of other kinds of file. only: refuses every ending but the given
  /// ones.
  enum class Endings { only, otherKindsRefused };

  /// `file`: the value of `option`, empty if it was not given. `endings`: with their dots, the usual one
  /// first.
  Outputs& add(std::string option, std::filesystem::path file, std::vector<std::string> endings,
               Endings strictness = Endings::only);

  /// Refuses a wrong ending, a file that cannot be written (requireWritable(), which makes its folder), two
  /// outputs that are one file, and an output that is one of `inputs`. Files are compared by device and
  /// inode, so that another name for the same file is found. An input may be empty, or a file that does not
  /// exist yet, such as a new store.
  void check(const std::vector<std::filesystem::path>& inputs) const;
  /// Refuses an output that this process has read under any name, such as a texture of the scene or an
  /// included text. Call it when all is read, before the work.
  void requireUnread() const;
  /// The same for one file: of a sequence add() gets only the first and the last.
  static void requireUnread(const std::string& option, const std::filesystem::path& file);

 private:
  struct Output {
    std::string option;
    std::filesystem::path file;
    std::vector<std::string> endings;
    Endings strictness;
  };
  static void checkEnding(const Output& output);
  std::vector<Output> outputs_;
};

}  // namespace lumivox::command
