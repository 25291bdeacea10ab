// The files that a command writes, checked before its work: one mechanism for all commands.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lumivox::command {

/// What a command is about to write. Whatever is wrong with it is an Error that names the option.
class Outputs {
 public:
  /// Names whose ending says another kind of file are refused; `only`: so is every other ending.
  enum class Endings { only, otherKindsRefused };

  /// `option` gave this name, empty when it was not given; `endings` with their dots, the usual one first.
  Outputs& add(std::string option, std::filesystem::path file, std::vector<std::string> endings,
               Endings strictness = Endings::only);

  /// Refuses a wrong ending, a file that cannot be written (requireWritable(), which makes its folder), two
  /// outputs that are one file, and one that is among `inputs`: under the same name or another that leads to
  /// it, by device and inode. An input may be empty, or a file that is made before it is read: a new store.
  void check(const std::vector<std::filesystem::path>& inputs) const;
  /// Refuses an output that this process has read, by whatever name: a texture of the scene, an included
  /// text. Called once all is read, before the work.
  void requireUnread() const;
  /// The same of one file: of a sequence only the first and the last are added.
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
