#include "common/table.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <numeric>

namespace lumivox::command {
namespace {

using Rows = std::vector<std::vector<std::string>>;

constexpr std::size_t kGap = 2;          // between columns
constexpr std::size_t kLeastWords = 16;  // least width to which a column of words is narrowed

bool looksLikeNumber(const std::string& text) {
  if (text.empty()) return true;
  const auto first = static_cast<unsigned char>(text[0] == '-' && text.size() > 1 ? text[1] : text[0]);
  return std::isdigit(first) != 0 || text == "-";
}

struct Column {
  std::size_t width = 0;  ///< as displayed
  std::size_t least = 0;  ///< width of its longest word
  bool numbers = true;    ///< aligned to the right
  bool words = false;     ///< may be broken at spaces
};

/// The width that the longest word of a text needs. Each word but the first may begin a line, which is
/// indented.
std::size_t longestWord(const std::string& text) {
  std::size_t longest = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    longest = std::max(longest,
                       shownWidth(std::string_view(text).substr(begin, end - begin)) + (begin > 0 ? 1 : 0));
    begin = end + 1;
  }
  return longest;
}

std::vector<Column> columnsOf(const Rows& rows) {
  std::vector<Column> columns;
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      if (c >= columns.size()) columns.push_back({0, 0, rows.size() > 1, false});
      Column& column = columns[c];
      const std::string& text = rows[r][c];
      column.width = std::max(column.width, shownWidth(text));
      column.least = std::max(column.least, longestWord(text));
      if (r == 0) continue;
      if (!looksLikeNumber(text)) column.numbers = false;
    }
  for (Column& column : columns) {
    column.words = !column.numbers && column.width > kLeastWords;
    column.least = column.words ? std::min(column.width, std::max(column.least, kLeastWords)) : column.width;
  }
  return columns;
}

std::size_t widthOf(const std::vector<Column>& columns, const std::vector<std::size_t>& chosen) {
  std::size_t width = chosen.empty() ? 0 : kGap * (chosen.size() - 1);
  for (const std::size_t c : chosen) width += columns[c].width;
  return width;
}

std::size_t leastOf(const std::vector<Column>& columns, const std::vector<std::size_t>& chosen) {
  std::size_t width = chosen.empty() ? 0 : kGap * (chosen.size() - 1);
  for (const std::size_t c : chosen) width += columns[c].least;
  return width;
}

/// Narrows the widest columns of words until the chosen columns fit into `room`.
void narrow(std::vector<Column>& columns, const std::vector<std::size_t>& chosen, std::size_t room) {
  for (std::size_t over = widthOf(columns, chosen); over > room; over = widthOf(columns, chosen)) {
    Column* widest = nullptr;
    for (const std::size_t c : chosen)
      if (columns[c].width > columns[c].least && (widest == nullptr || columns[c].width > widest->width))
        widest = &columns[c];
    if (widest == nullptr) return;
    --widest->width;
  }
}

/// The lines of a cell in a column of this width.
std::vector<std::string> linesOf(const std::string& text, std::size_t width) {
  if (shownWidth(text) <= width) return {text};
  // An indented cell stays indented.
  const std::size_t indent = std::min(text.find_first_not_of(' '), text.size());
  const std::string broken = std::string(indent, ' ') + wrapped(text, width - std::min(width, indent), 1);
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin <= broken.size();) {
    const std::size_t end = std::min(broken.find('\n', begin), broken.size());
    std::string line = (begin == 0 ? "" : std::string(indent, ' ')) + broken.substr(begin, end - begin);
    // A word that is wider than the column is split, after a slash if it has one.
    for (; shownWidth(line) > width && line.size() > width; line.erase(0, lines.back().size())) {
      const std::size_t slash = line.rfind('/', width - 1);
      lines.push_back(line.substr(0, slash == std::string::npos || slash == 0 ? width : slash + 1));
    }
    lines.push_back(std::move(line));
    begin = end + 1;
  }
  return lines;
}

std::string block(const Rows& rows, const std::vector<Column>& columns,
                  const std::vector<std::size_t>& chosen) {
  std::string text;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    std::vector<std::vector<std::string>> cells;
    std::size_t height = 1;
    for (const std::size_t c : chosen) {
      cells.push_back(c < rows[r].size() ? linesOf(rows[r][c], columns[c].width)
                                         : std::vector<std::string>{""});
      height = std::max(height, cells.back().size());
    }
    for (std::size_t l = 0; l < height; ++l) {
      std::string line;
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        const Column& column = columns[chosen[i]];
        const std::string cell = l < cells[i].size() ? cells[i][l] : std::string();
        const std::string padding(column.width - std::min(column.width, shownWidth(cell)), ' ');
        line += (i == 0 ? "" : std::string(kGap, ' ')) + (column.numbers ? padding + cell : cell + padding);
      }
      line.erase(line.find_last_not_of(' ') + 1);
      text += (r == 0 && rows.size() > 1 ? painted(Paint::heading, line) : line) + "\n";
    }
  }
  return text;
}

}  // namespace

int outputColumns() {
  return terminalColumns(STDOUT_FILENO);
}

std::string painted(Paint paint, std::string_view text) {
  static const bool colour = takesColour(STDOUT_FILENO);
  return lumivox::painted(paint, text, colour && !text.empty());
}

std::string textTable(const std::vector<std::vector<std::string>>& rows, std::size_t keys, int columns) {
  const auto room = static_cast<std::size_t>(columns > 0 ? columns : outputColumns());
  std::vector<Column> all = columnsOf(rows);
  std::vector<std::size_t> chosen(all.size());
  std::iota(chosen.begin(), chosen.end(), std::size_t{0});
  if (leastOf(all, chosen) <= room) {
    narrow(all, chosen, room);
    return block(rows, all, chosen);
  }
  // Written in blocks. The key columns leave at least half of the room to the others.
  keys = std::min(keys, all.size());
  const std::vector<std::size_t> head(chosen.begin(), chosen.begin() + static_cast<std::ptrdiff_t>(keys));
  narrow(all, head, std::max(room / 2, leastOf(all, head)));
  for (const std::size_t c : head) all[c].least = all[c].width;
  std::string text;
  for (std::size_t c = keys; c < all.size();) {
    std::vector<std::size_t> some = head;
    do {
      some.push_back(c++);
    } while (c < all.size() && [&] {
      std::vector<std::size_t> more = some;
      more.push_back(c);
      return leastOf(all, more) <= room;
    }());
    std::vector<Column> own = all;
    if (const std::size_t least = leastOf(own, some); least > room) {
      Column& last = own[some.back()];
      last.least -= std::min(last.least - 1, least - room);
    }
    narrow(own, some, room);
    text += (text.empty() ? "" : "\n") + block(rows, own, some);
  }
  return text;
}

std::string groupedTable(const std::vector<std::vector<std::string>>& rows, std::size_t keys, int columns) {
  std::string text;
  for (std::size_t first = 1; first < rows.size();) {
    Rows group{{rows.front().begin() + 1, rows.front().end()}};
    const std::string& name = rows[first].front();
    for (; first < rows.size() && rows[first].front() == name; ++first)
      group.emplace_back(rows[first].begin() + 1, rows[first].end());
    text += (text.empty() ? "" : "\n") + name + "\n" + textTable(group, keys, columns);
  }
  return text;
}

std::string remarks(const std::string& text) {
  std::string result;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    result += wrapped(std::string_view(text).substr(begin, end - begin),
                      static_cast<std::size_t>(outputColumns()), 2) +
              "\n";
    begin = end + 1;
  }
  return result;
}

}  // namespace lumivox::command
