// Which components of a texture are shown.
#pragma once

#include <string>
#include <vector>

namespace lumivox::viewer {

/// The components that are shown: the first three as red, green and blue, or a single one.
enum class Channel { colour, x, y, z, w };

/// Their words in scripts, in the same order.
inline const std::vector<std::string>& channelWords() {
  static const std::vector<std::string> words{"colour", "x", "y", "z", "w"};
  return words;
}

}  // namespace lumivox::viewer
