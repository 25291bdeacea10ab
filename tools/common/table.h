// Tables of texts that fit the terminal, and what they are made of.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lumivox/base/terminal.h"

namespace lumivox::command {

/// Columns of what standard output goes to.
int outputColumns();
/// A text on standard output, coloured where that is a terminal that takes it.
std::string painted(Paint paint, std::string_view text);

/// Lays rows out in columns; the first row is the head, and columns of numbers align to the right. A table
/// that is wider than `columns` (0: outputColumns()) breaks its columns of words at spaces, where that is
/// enough; else it is written in blocks, one below the other: each has the first `keys` columns and as many
/// of the others as fit.
std::string textTable(const std::vector<std::vector<std::string>>& rows, std::size_t keys = 1,
                      int columns = 0);

/// A table for each run of rows with the same first cell, which is its heading; `keys` of the columns after
/// it.
std::string groupedTable(const std::vector<std::vector<std::string>>& rows, std::size_t keys = 1,
                         int columns = 0);

/// Remarks below a table: broken at spaces to fit the terminal, further lines indented. Every line of `text`
/// is one remark.
std::string remarks(const std::string& text);

}  // namespace lumivox::command
