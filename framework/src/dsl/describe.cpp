// Descriptions of words from the tables that the checker uses.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <set>
#include <utility>

#include "dsl/wording.h"

namespace lumivox::dsl {
namespace {

using Path = std::vector<std::string>;

/// One description and all places where it holds.
struct Described {
  std::string title, lines;
  std::vector<std::string> places = {};

  std::string text() const {
    return title + (places.empty() ? "" : fmt::format(" (in {})", fmt::join(places, ", "))) + "\n" + lines;
  }
};

std::string signature(const BlockSpecification& block) {
  std::string text = block.word;
  if (block.name == HeaderUse::required) text += " NAME";
  if (block.name == HeaderUse::optional) text += " [NAME]";
  if (!block.kinds.empty()) text += fmt::format(" {}", fmt::join(block.kinds, "|"));
  if (block.anyKind) text += " KIND";
  return text + " { ... }";
}

std::string notes(const PropertySpecification& property) {
  std::string text = expectation(property);
  if (property.required) {
    text += "; required";
  } else if (!property.defaultText.empty()) {
    text += "; default " + property.defaultText;
  }
  if (property.repeatable) text += "; may be repeated";
  return text;
}

Described described(const PropertySpecification& property) {
  return {property.word, fmt::format("  {}\n  {}\n", property.meaning, notes(property))};
}

std::string propertyList(const std::vector<PropertySpecification>& properties) {
  std::size_t width = 0;
  for (const PropertySpecification& property : properties) width = std::max(width, property.word.size());
  std::string text;
  for (const PropertySpecification& property : properties) {
    text += fmt::format("  {:<{}}  {} ({})\n", property.word, width, property.meaning, notes(property));
  }
  return text;
}

Described described(const BlockSpecification& block) {
  std::string text = fmt::format("  {}\n", block.meaning);
  text += propertyList(block.properties);
  for (const auto& [kind, properties] : block.kindProperties) {
    text += fmt::format(" {} {}:\n{}", block.word, kind, propertyList(properties));
  }
  for (const BlockSpecification& inner : block.blocks)
    text += fmt::format("  {}  {}\n", signature(inner), inner.meaning);
  return {signature(block), std::move(text)};
}

/// Visits every block and property with the words of its enclosing blocks.
struct Visitor {
  std::function<void(const BlockSpecification&, const Path&)> block;
  std::function<void(const PropertySpecification&, const Path&)> property;

  void visit(const std::vector<BlockSpecification>& blocks, Path& path) const {
    for (const BlockSpecification& one : blocks) {
      block(one, path);
      path.push_back(one.word);
      for (const PropertySpecification& inner : one.properties) property(inner, path);
      for (const auto& [kind, properties] : one.kindProperties) {
        path.back() = one.word + ' ' + kind;
        for (const PropertySpecification& inner : properties) property(inner, path);
      }
      path.back() = one.word;
      visit(one.blocks, path);
      path.pop_back();
    }
  }
};

std::string cell(std::string text) {
  for (std::size_t i = 0; (i = text.find('|', i)) != std::string::npos; i += 2) text.insert(i, 1, '\\');
  return text;
}

std::string table(const std::vector<PropertySpecification>& properties) {
  if (properties.empty()) return {};
  std::string text = "| property | value | default | meaning |\n|---|---|---|---|\n";
  for (const PropertySpecification& property : properties) {
    text += fmt::format("| `{}` | {}{} | {} | {} |\n", property.word, cell(expectation(property)),
                        property.repeatable ? "; may be repeated" : "",
                        property.required              ? "required"
                        : property.defaultText.empty() ? "-"
                                                       : '`' + cell(property.defaultText) + '`',
                        cell(property.meaning));
  }
  return text + '\n';
}

void markdown(const std::vector<BlockSpecification>& blocks, const std::string& level, std::string& text) {
  constexpr std::size_t kDeepestHeading = 6;
  for (const BlockSpecification& block : blocks) {
    text += fmt::format("{} `{}`\n\n{}\n\n", level, signature(block), block.meaning);
    text += table(block.properties);
    for (const auto& [kind, properties] : block.kindProperties) {
      text += fmt::format("Of the kind `{}`:\n\n{}", kind, table(properties));
    }
    markdown(block.blocks, level.size() < kDeepestHeading ? level + '#' : level, text);
  }
}

}  // namespace

std::vector<std::string> words(const std::vector<BlockSpecification>& specifications) {
  std::set<std::string> all;
  const Visitor visitor{
      [&](const BlockSpecification& block, const Path&) { all.insert(block.word); },
      [&](const PropertySpecification& property, const Path&) { all.insert(property.word); }};
  Path path;
  visitor.visit(specifications, path);
  return {all.begin(), all.end()};
}

std::string describe(const std::vector<BlockSpecification>& specifications, const std::string& word) {
  std::vector<Described> all;
  const auto add = [&](Described one, const Path& path) {
    const auto same = std::find_if(all.begin(), all.end(), [&](const Described& other) {
      return other.title == one.title && other.lines == one.lines;
    });
    Described& known = same == all.end() ? all.emplace_back(std::move(one)) : *same;
    if (!path.empty()) known.places.push_back(fmt::format("{}", fmt::join(path, " > ")));
  };
  const Visitor visitor{[&](const BlockSpecification& block, const Path& path) {
                          if (block.word == word) add(described(block), path);
                        },
                        [&](const PropertySpecification& property, const Path& path) {
                          if (property.word == word) add(described(property), path);
                        }};
  Path path;
  visitor.visit(specifications, path);
  std::string text;
  for (const Described& one : all) text += (text.empty() ? "" : "\n") + one.text();
  return text;
}

std::string describeAsMarkdown(const std::vector<BlockSpecification>& specifications) {
  std::string text;
  markdown(specifications, "##", text);
  return text;
}

}  // namespace lumivox::dsl
