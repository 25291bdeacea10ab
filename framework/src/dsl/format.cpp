// The canonical layout. It keeps line breaks between statements, and sets blanks, indentation, units and the
// alignment of neighbouring one-line blocks. Lines that are too long break between statements.
#include <algorithm>
#include <cassert>

#include "lumivox/dsl/document.h"

namespace lumivox::dsl {
namespace {

constexpr std::size_t kLineWidth = 110;
constexpr std::size_t kIndent = 2;

/// Width in characters, not bytes.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) != 0x80u; }));
}

std::string propertyText(const Property& property) {
  std::string text = property.word;
  for (const Value& value : property.values) text += ' ' + value.written();
  return text;
}

bool hasComments(const Item& item) {
  return !item.commentsBefore.empty() || !item.commentAfter.empty();
}

/// Whether a block stays on one line: it was written so and contains only properties without comments.
bool mayStandOnOneLine(const Block& block) {
  if (!block.commentAfterOpen.empty() || !block.commentsAtEnd.empty()) return false;
  return std::all_of(block.items.begin(), block.items.end(), [](const Item& item) {
    return item.property && !item.startsLine && !hasComments(item);
  });
}

std::string inner(const Block& block) {
  std::string text = "{ ";
  for (std::size_t i = 0; i < block.items.size(); ++i) {
    if (i > 0) text += "  ";
    text += propertyText(*block.items[i].property);
  }
  return text + (block.items.empty() ? "}" : " }");
}

bool fitsOneLine(const Block& block, std::size_t indent) {
  return mayStandOnOneLine(block) && indent + width(block.title()) + 1 + width(inner(block)) <= kLineWidth;
}

class Formatter {
 public:
  std::string run(const Document& document) {
    items(document.items, 0);
    commentLines(document.commentsAtEnd, 0);
    return std::move(text_);
  }

 private:
  void indent(std::size_t depth) { text_.append(depth * kIndent, ' '); }

  void commentLines(const std::vector<std::string>& comments, std::size_t depth) {
    for (const std::string& comment : comments) {
      if (comment.empty()) {
        if (!text_.empty()) text_ += '\n';
        continue;
      }
      indent(depth);
      text_ += comment + '\n';
    }
  }

  void items(const std::vector<Item>& all, std::size_t depth) {
    for (std::size_t i = 0; i < all.size();) {
      if (i > 0 && all[i].blankLineBefore) text_ += '\n';
      if (all[i].block) {
        i = fitsOneLine(*all[i].block, depth * kIndent) ? blockRun(all, i, depth) : longBlock(all, i, depth);
      } else {
        i = propertyLine(all, i, depth);
      }
    }
  }

  /// Lays out properties that were written on one line.
  std::size_t propertyLine(const std::vector<Item>& all, std::size_t i, std::size_t depth) {
    commentLines(all[i].commentsBefore, depth);
    indent(depth);
    std::string line = propertyText(*all[i].property);
    while (all[i].commentAfter.empty() && i + 1 < all.size() && all[i + 1].property &&
           !all[i + 1].startsLine && all[i + 1].commentsBefore.empty()) {
      const std::string next = propertyText(*all[i + 1].property);
      if (depth * kIndent + width(line) + 2 + width(next) > kLineWidth) break;
      line += "  " + next;
      ++i;
    }
    text_ += line;
    endLine(all[i]);
    return i + 1;
  }

  /// Aligns the headers and braces of neighbouring one-line blocks with the same word.
  std::size_t blockRun(const std::vector<Item>& all, std::size_t first, std::size_t depth) {
    std::size_t end = first + 1;
    const Block& model = *all[first].block;
    while (end < all.size() && all[end].block && !all[end].blankLineBefore &&
           all[end].commentsBefore.empty() && all[end].block->word == model.word &&
           all[end].block->header.size() == model.header.size() &&
           fitsOneLine(*all[end].block, depth * kIndent)) {
      ++end;
    }
    std::vector<std::size_t> columns(model.header.size(), 0);
    for (std::size_t i = first; i < end; ++i) {
      for (std::size_t c = 0; c < columns.size(); ++c) {
        columns[c] = std::max(columns[c], width(all[i].block->header[c].written()));
      }
    }
    bool aligned = true;
    for (std::size_t i = first; i < end; ++i)
      aligned = aligned && width(blockLine(*all[i].block, columns)) + depth * kIndent <= kLineWidth;
    for (std::size_t i = first; i < end; ++i) {
      commentLines(all[i].commentsBefore, depth);
      indent(depth);
      text_ += blockLine(*all[i].block, aligned ? columns : std::vector<std::size_t>(columns.size(), 0));
      endLine(all[i]);
    }
    return end;
  }

  static std::string blockLine(const Block& block, const std::vector<std::size_t>& columns) {
    std::string line = block.word;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::string value = block.header[c].written();
      line += ' ' + value;
      if (columns[c] > width(value)) line.append(columns[c] - width(value), ' ');
    }
    return line + ' ' + inner(block);
  }

  std::size_t longBlock(const std::vector<Item>& all, std::size_t i, std::size_t depth) {
    const Block& block = *all[i].block;
    commentLines(all[i].commentsBefore, depth);
    indent(depth);
    text_ += block.title() + " {";
    if (!block.commentAfterOpen.empty()) text_ += "  " + block.commentAfterOpen;
    text_ += '\n';
    items(block.items, depth + 1);
    commentLines(block.commentsAtEnd, depth + 1);
    indent(depth);
    text_ += '}';
    endLine(all[i]);
    return i + 1;
  }

  void endLine(const Item& item) {
    if (!item.commentAfter.empty()) text_ += "  " + item.commentAfter;
    text_ += '\n';
  }

  std::string text_;
};

}  // namespace

std::string format(const Document& document) {
  assert(document.findings.empty());
  return Formatter().run(document);
}

}  // namespace lumivox::dsl
