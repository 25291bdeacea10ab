// Text tables that fit the terminal, and their parts.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lumivox/base/terminal.h"

namespace lumivox::command {

/// The width of standard output's terminal, in columns.
int outputColumns();
/// The text, coloured if standard output is a terminal that supports it.
std::string painted(Paint paint, std::string_view text);

/// Lays rows out in columns. The first row is the head, and columns of numbers align to the right. In a table
/// wider than `columns` (0: outputColumns()), columns of words wrap at spaces. If that is not enough, the
/// table is written in blocks, one below the other, each with the first `keys` columns and as many of the
/// others as fit.
std::string textTable(const std::vector<std::vector<std::string>>& rows, std::size_t keys = 1,
                      int columns = 0);

/// One table for each run of rows with the same first cell, which becomes its heading. `keys` counts the
/// columns after it.
std::string groupedTable(const std::vector<std::vector<std::string>>& rows, std::size_t keys = 1,
                         int columns = 0);

/// Remarks below a table, one a line of `text`: wrapped at spaces to fit the terminal, with further lines
/// indented.
std::string remarks(const std::string& text);

}  // namespace lumivox::command
