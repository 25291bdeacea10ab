// The terminal that a person reads: how wide it is, whether it takes colours, and texts that fit it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace lumivox {

/// Width of what is no terminal, and of a terminal that does not tell its own.
inline constexpr int kUsualColumns = 100;

/// Columns of the terminal behind a file descriptor, at least 20: $COLUMNS where it is a number, else what
/// the terminal says, else kUsualColumns.
int terminalColumns(int descriptor);
/// Whether it is a terminal that takes colours: NO_COLOR is unset or empty and TERM is not "dumb".
bool takesColour(int descriptor);

enum class Paint { heading, good, bad, warning };
/// The text between escape sequences that colour it; as it is where `colour` is false.
std::string painted(Paint paint, std::string_view text, bool colour);

/// Columns that a terminal shows UTF-8 text in: its code points, without the sequences that colour it.
std::size_t shownWidth(std::string_view text);
/// The text, or as much of it as leaves room for two dots; whole characters of UTF-8, nothing that colours.
std::string cutTo(std::string_view text, std::size_t columns);
/// Broken at spaces into lines of at most so many columns, as far as words allow; the lines after the first
/// begin with `indent` spaces. Without a line break at the end.
std::string wrapped(std::string_view text, std::size_t columns, std::size_t indent = 0);

std::string durationText(double seconds);  ///< "12 s", "4 min", "1.5 h"

}  // namespace lumivox
