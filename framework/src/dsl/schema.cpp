#include "lumivox/dsl/schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>
#include <utility>

#include "dsl/consequences.h"
#include "dsl/wording.h"

namespace lumivox::dsl {
namespace {

using Findings = std::vector<Diagnostic>;

std::vector<std::string> wordsOf(const std::vector<const PropertySpecification*>& properties,
                                 const std::vector<BlockSpecification>& blocks) {
  std::vector<std::string> words;
  for (const PropertySpecification* property : properties) words.push_back(property->word);
  for (const BlockSpecification& block : blocks) words.push_back(block.word);
  return words;
}

/// The properties that a block of this kind may have; of every kind when the kind is unknown.
std::vector<const PropertySpecification*> propertiesOf(const BlockSpecification& specification,
                                                       const std::string& kind) {
  std::vector<const PropertySpecification*> result;
  for (const PropertySpecification& property : specification.properties) result.push_back(&property);
  const auto& kinds = specification.kinds;
  const bool known = std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
  for (const auto& [name, properties] : specification.kindProperties) {
    if (known && name != kind) continue;
    for (const PropertySpecification& property : properties) result.push_back(&property);
  }
  return result;
}

template <class Specification>
const Specification* byWord(const std::vector<Specification>& all, const std::string& word) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const Specification& one) { return one.word == word; });
  return found == all.end() ? nullptr : &*found;
}

/// Which header values are name and kind.
struct Header {
  const Value* name = nullptr;
  const Value* kind = nullptr;
};

Header headerOf(const Block& block, const BlockSpecification& specification) {
  Header header;
  const bool hasKind = specification.anyKind || !specification.kinds.empty();
  if (block.header.empty()) return header;
  if (!hasKind) {
    header.name = &block.header[0];
  } else if (specification.name == HeaderUse::none) {
    header.kind = &block.header[0];
  } else if (block.header.size() == 1) {
    const auto& kinds = specification.kinds;
    const bool isKind = std::find(kinds.begin(), kinds.end(), block.header[0].text) != kinds.end();
    (isKind && specification.name == HeaderUse::optional ? header.kind : header.name) = &block.header[0];
  } else {
    header.name = &block.header[0];
    header.kind = &block.header[1];
  }
  return header;
}

/// Checks of one block.
class BlockChecker {
 public:
  BlockChecker(const Document& document, const Block& block, const BlockSpecification& specification,
               Findings& findings)
      : document_(document), block_(block), specification_(specification), findings_(findings) {}

  void run() {
    checkHeader();
    const Header header = headerOf(block_, specification_);
    properties_ = propertiesOf(specification_, header.kind != nullptr ? header.kind->text : std::string());
    for (std::size_t i = 0; i < block_.items.size(); ++i) {
      const Item& item = block_.items[i];
      const bool cutOff = !block_.closed && i + 1 == block_.items.size();
      if (item.block) {
        checkItem(*item.block);
      } else if (!cutOff) {
        const std::size_t before = findings_.size();
        if (i + 1 < block_.items.size() && takesWordAsUnit(*item.property, block_.items[i + 1])) {
          ++i;
          continue;
        }
        checkItem(*item.property, i > 0 ? &block_.items[i - 1] : nullptr);
        if (findings_.size() > before) i += consequencesOf(*item.property, i + 1);
      }
    }
    // Properties count as missing only if the whole text was read.
    if (block_.closed && document_.findings.empty()) checkMissing();
  }

 private:
  int wordLength() const { return static_cast<int>(block_.word.size()); }

  void report(const SourcePlace& place, int length, std::string what, std::string expected = {},
              std::string suggestion = {}) {
    findings_.push_back(
        document_.finding(place, length, std::move(what), std::move(expected), std::move(suggestion)));
  }

  void checkHeader() {
    const Header header = headerOf(block_, specification_);
    const bool hasKind = specification_.anyKind || !specification_.kinds.empty();
    if (specification_.name == HeaderUse::required && header.name == nullptr) {
      report(block_.place, wordLength(), fmt::format("block '{}' lacks a name", block_.word),
             fmt::format("{} NAME {}{{ ... }}", block_.word, hasKind ? "KIND " : ""));
    }
    if (hasKind) checkKind(header);
    const std::size_t allowed = (specification_.name != HeaderUse::none ? 1u : 0u) + (hasKind ? 1u : 0u);
    if (block_.header.size() > allowed) {
      const Value& extra = block_.header[allowed];
      report(extra.place, extra.length,
             fmt::format("unexpected '{}' in the header of block '{}'", extra.text, block_.word),
             allowed == 0   ? "'{' right after the word"
             : allowed == 1 ? fmt::format("'{{' behind one name; \"{} {}\" in double quotes is one",
                                          block_.header[0].text, extra.text)
                            : fmt::format("'{{' behind {} values", allowed));
    }
  }

  /// `light point main` for `light main point`
  bool namesSwapped(const Header& header) const {
    const auto& kinds = specification_.kinds;
    return header.name != nullptr && std::find(kinds.begin(), kinds.end(), header.name->text) != kinds.end();
  }

  void checkKind(const Header& header) {
    if (header.kind == nullptr) {
      report(block_.place, wordLength(), fmt::format("block '{}' lacks its kind", block_.title()),
             specification_.anyKind ? "a second word in its header" : oneOf(specification_.kinds));
      return;
    }
    const auto& kinds = specification_.kinds;
    if (!specification_.anyKind && std::find(kinds.begin(), kinds.end(), header.kind->text) == kinds.end()) {
      report(header.kind->place, header.kind->length,
             fmt::format("unknown kind '{}' of block '{}'", header.kind->text, block_.word), oneOf(kinds),
             namesSwapped(header) ? fmt::format("{} {} {}", block_.word, header.kind->text, header.name->text)
                                  : suggestionFor(findings_, header.kind->text, kinds));
    }
  }

  const PropertySpecification* specificationOf(const Property& property) const {
    const auto found =
        std::find_if(properties_.begin(), properties_.end(),
                     [&](const PropertySpecification* one) { return one->word == property.word; });
    return found == properties_.end() ? nullptr : *found;
  }

  /// An unknown word behind a number without a unit, where one belongs: `fov 70 degrees`.
  bool takesWordAsUnit(const Property& property, const Item& next) {
    const PropertySpecification* specification = specificationOf(property);
    if (specification == nullptr || specification->dimension == kNoDimension || property.values.empty() ||
        !next.property || specificationOf(*next.property) != nullptr)
      return false;
    const Value& last = property.values.back();
    const Property& word = *next.property;
    // Values behind the word are a property of their own: `fov 70 degrees resolution 24 16`.
    if (!word.values.empty()) {
      if (!word.values.front().isPlainWord()) return false;
      firstPlaces_.emplace(word.values.front().text, word.values.front().place);
    }
    if (last.kind != ValueKind::number || last.unit || last.place.line != word.place.line) return false;
    std::vector<std::string> units;
    for (const Unit& unit : knownUnits())
      if (unit.dimension == specification->dimension) units.push_back(unit.name);
    firstPlaces_.emplace(property.word, property.place);
    report(word.place, static_cast<int>(word.word.size()), fmt::format("unknown unit '{}'", word.word),
           quantity(specification->dimension), suggestionFor(findings_, word.word, units));
    return true;
  }

  /// The number of unknown properties behind a wrong one on its line, which share its mistake: `resolution 24
  /// x 16`.
  std::size_t consequencesOf(const Property& property, std::size_t next) const {
    if (specificationOf(property) == nullptr) return 0;
    std::size_t count = 0;
    for (; next < block_.items.size() && block_.items[next].property; ++next, ++count) {
      const Property& other = *block_.items[next].property;
      if (other.place.line != property.place.line || specificationOf(other) != nullptr ||
          !nearestWord(other.word, wordsOf(properties_, specification_.blocks)).empty())
        break;
    }
    return count;
  }

  /// `before`: the item before it, if any.
  void checkItem(const Property& property, const Item* before) {
    const auto found =
        std::find_if(properties_.begin(), properties_.end(),
                     [&](const PropertySpecification* one) { return one->word == property.word; });
    if (found == properties_.end()) return reportUnknown(property, before);
    const auto [first, isNew] = firstPlaces_.emplace(property.word, property.place);
    if (!isNew && !(*found)->repeatable) {
      report(property.place, static_cast<int>(property.word.size()),
             fmt::format("property '{}' is given twice", property.word),
             fmt::format("it once; it was given first at {}", first->second.text()));
    }
    checkProperty(document_, property, **found, findings_);
  }

  void reportUnknown(const Property& property, const Item* before) {
    if (specification_.open) return;
    const int length = static_cast<int>(property.word.size());
    strangers_.push_back({property.word, &property});
    if (byWord(specification_.blocks, property.word) != nullptr) {
      return report(property.place, length, fmt::format("'{}' is a block", property.word),
                    fmt::format("{} ... {{ ... }}", property.word));
    }
    // A lone word behind a number without a unit, on its line, is taken as a unit.
    if (property.values.empty() && mayBeUnit(property, before)) {
      const std::vector<std::string> units = unitNames();
      if (const std::string unit = nearestWord(property.word, units); !unit.empty()) {
        return report(property.place, length, fmt::format("unknown unit or property '{}'", property.word),
                      oneOf(units), unit);
      }
    }
    const std::vector<std::string> known = wordsOf(properties_, specification_.blocks);
    report(property.place, length,
           fmt::format("unknown property '{}' in block '{}'", property.word, block_.title()),
           known.empty() ? "no property here" : oneOf(known), suggestionFor(findings_, property.word, known));
  }

  static bool mayBeUnit(const Property& property, const Item* before) {
    if (before == nullptr || !before->property || before->property->values.empty()) return false;
    const Value& last = before->property->values.back();
    return last.kind == ValueKind::number && !last.unit && last.place.line == property.place.line;
  }

  static std::vector<std::string> unitNames() {
    std::vector<std::string> names;
    for (const Unit& unit : knownUnits()) names.push_back(unit.name);
    return names;
  }

  void checkItem(const Block& inner) {
    const BlockSpecification* specification = byWord(specification_.blocks, inner.word);
    const int length = static_cast<int>(inner.word.size());
    if (specification == nullptr) {
      const bool isProperty =
          std::any_of(properties_.begin(), properties_.end(),
                      [&](const PropertySpecification* one) { return one->word == inner.word; });
      if (isProperty) {
        firstPlaces_.emplace(inner.word, inner.place);
        // `file "room.obj" use { ... }` on one line
        if (inner.header.size() > 1 && byWord(specification_.blocks, inner.header.back().text) != nullptr) {
          const Value& word = inner.header.back();
          return report(
              word.place, word.length, fmt::format("a line break is missing before '{}'", word.text),
              fmt::format("block '{}' on a line of its own, behind property '{}'", word.text, inner.word));
        }
        return report(inner.place, length, fmt::format("'{}' is a property, not a block", inner.word),
                      fmt::format("{} and its values; a block after them starts a new line", inner.word));
      }
      strangers_.push_back({inner.word, nullptr});
      std::vector<std::string> known;
      for (const BlockSpecification& one : specification_.blocks) known.push_back(one.word);
      return report(
          inner.place, length, fmt::format("unknown block '{}' in block '{}'", inner.word, block_.title()),
          known.empty() ? "no block here" : oneOf(known), suggestionFor(findings_, inner.word, known));
    }
    checkDuplicate(inner, *specification);
    check(document_, inner, *specification, findings_);
  }

  void checkDuplicate(const Block& inner, const BlockSpecification& specification) {
    const Header header = headerOf(inner, specification);
    if (specification.repeatable && header.name == nullptr) return;
    const std::string key = specification.repeatable ? inner.word + ' ' + header.name->text : inner.word;
    const auto [first, isNew] = firstPlaces_.emplace(key, inner.place);
    if (isNew) return;
    report(inner.place, static_cast<int>(inner.word.size()),
           specification.repeatable
               ? fmt::format("block '{}' named '{}' is given twice", inner.word, header.name->text)
               : fmt::format("block '{}' is given twice", inner.word),
           fmt::format("{}; it was given first at {}", specification.repeatable ? "another name" : "it once",
                       first->second.text()));
  }

  /// Whether an unknown word, which has its own finding, is probably the missing one: its values fit, or the
  /// words are similar. Each unknown word replaces one missing word.
  bool standsIn(const std::string& missing, const PropertySpecification* specification) {
    const auto stands = [&](const Stranger& stranger) {
      if (nearestWord(stranger.word, {missing}) == missing) return true;
      if ((stranger.property != nullptr) != (specification != nullptr)) return false;
      if (specification == nullptr) return true;
      Findings misfits;
      checkProperty(document_, *stranger.property, *specification, misfits);
      return misfits.empty();
    };
    const auto found = std::find_if(strangers_.begin(), strangers_.end(), stands);
    if (found == strangers_.end()) return false;
    strangers_.erase(found);
    return true;
  }

  /// Whether the kind, which decides the properties, is unknown.
  bool kindIsUnknown() const {
    if (specification_.kindProperties.empty()) return false;
    const Header header = headerOf(block_, specification_);
    const auto& kinds = specification_.kinds;
    return header.kind == nullptr || std::find(kinds.begin(), kinds.end(), header.kind->text) == kinds.end();
  }

  void checkMissing() {
    if (kindIsUnknown()) return;
    for (const PropertySpecification* property : properties_) {
      if (!property->required || firstPlaces_.count(property->word) > 0) continue;
      if (standsIn(property->word, property)) continue;
      report(block_.place, wordLength(),
             fmt::format("block '{}' lacks the property '{}'", block_.title(), property->word),
             fmt::format("{} with {}", property->word, expectation(*property)));
    }
    for (const BlockSpecification& inner : specification_.blocks) {
      if (!inner.required) continue;
      const bool present = std::any_of(block_.items.begin(), block_.items.end(), [&](const Item& item) {
        return item.block && item.block->word == inner.word;
      });
      if (present || standsIn(inner.word, nullptr)) continue;
      report(block_.place, wordLength(),
             fmt::format("block '{}' lacks a block '{}'", block_.title(), inner.word),
             fmt::format("{} ... {{ ... }}: {}", inner.word, inner.meaning));
    }
  }

  const Document& document_;
  const Block& block_;
  const BlockSpecification& specification_;
  Findings& findings_;
  std::vector<const PropertySpecification*> properties_;
  std::map<std::string, SourcePlace> firstPlaces_;  // of properties by word, of blocks by word and name
  struct Stranger {
    std::string word;
    const Property* property;  // null: a block
  };
  std::vector<Stranger> strangers_;  // items that no table knows
};

}  // namespace

void check(const Document& document, const Block& block, const BlockSpecification& specification,
           Findings& findings) {
  BlockChecker(document, block, specification, findings).run();
}

namespace {

/// The missing block that a top-level item belongs into. `atTop`: the words at the top level of the text.
const BlockSpecification* missingAround(const std::set<std::string>& atTop, const std::string& word,
                                        const std::vector<BlockSpecification>& allowed) {
  for (const BlockSpecification& one : allowed) {
    const bool isInside = byWord(one.blocks, word) != nullptr || byWord(one.properties, word) != nullptr;
    if (isInside && atTop.count(one.word) == 0) return &one;
  }
  return nullptr;
}

}  // namespace

void check(const Document& document, const std::vector<BlockSpecification>& allowed, Findings& findings) {
  std::vector<std::string> known;
  for (const BlockSpecification& one : allowed) known.push_back(one.word);
  std::map<std::string, SourcePlace> firstPlaces;
  std::set<std::string> present;
  bool whole = true;     // false for a truncated text, of which nothing counts as missing
  bool outside = false;  // a top-level item belongs into a missing block
  std::set<std::string> misspelt, atTop;
  for (const Item& item : document.items) atTop.insert(item.block ? item.block->word : item.property->word);
  for (const Item& item : document.items) {
    const std::string& word = item.block ? item.block->word : item.property->word;
    const SourcePlace& place = item.block ? item.block->place : item.property->place;
    const int length = static_cast<int>(word.size());
    const BlockSpecification* specification = byWord(allowed, word);
    if (specification == nullptr) {
      const BlockSpecification* around = missingAround(atTop, word, allowed);
      if (around != nullptr) {
        if (!std::exchange(outside, true)) reportOutside(document, item, around->word, findings);
        continue;
      }
      misspelt.insert(nearestWord(word, known));
      findings.push_back(document.finding(
          place, length, fmt::format("unknown {} '{}'", item.block ? "block" : "property", word),
          oneOf(known), suggestionFor(findings, word, known)));
      continue;
    }
    present.insert(word);
    if (!item.block) {
      findings.push_back(document.finding(place, length, fmt::format("'{}' is a block", word),
                                          fmt::format("{} ... {{ ... }}", word)));
      continue;
    }
    whole = whole && item.block->closed;
    const Header header = headerOf(*item.block, *specification);
    const std::string key =
        word + (specification->repeatable && header.name != nullptr ? ' ' + header.name->text : "");
    const auto [first, isNew] = firstPlaces.emplace(key, place);
    if (!isNew && (!specification->repeatable || header.name != nullptr)) {
      findings.push_back(
          document.finding(place, length, fmt::format("block '{}' is given twice", item.block->title()),
                           fmt::format("one; it was given first at {}", first->second.text())));
    }
    check(document, *item.block, *specification, findings);
  }
  if (outside || (!document.findings.empty() && document.items.empty())) return;
  for (const BlockSpecification& one : allowed) {
    if (!one.required || present.count(one.word) > 0 || misspelt.count(one.word) > 0 || !whole) continue;
    findings.push_back(document.finding({document.file.string(), 0, 0}, 1,
                                        fmt::format("the text lacks a block '{}'", one.word),
                                        fmt::format("{} ... {{ ... }}: {}", one.word, one.meaning)));
  }
}

std::string CheckedBlock::name() const {
  const Header header = headerOf(*block_, *specification_);
  return header.name != nullptr ? header.name->text : std::string();
}

std::string CheckedBlock::kind() const {
  const Header header = headerOf(*block_, *specification_);
  return header.kind != nullptr ? header.kind->text : std::string();
}

std::vector<const Block*> CheckedBlock::blocks(const std::string& word) const {
  std::vector<const Block*> result;
  for (const Item& item : block_->items) {
    if (item.block && item.block->word == word) result.push_back(item.block.get());
  }
  return result;
}

const Property* CheckedBlock::find(const std::string& word) const {
  for (const Item& item : block_->items) {
    if (item.property && item.property->word == word) return &*item.property;
  }
  return nullptr;
}

std::vector<const Property*> CheckedBlock::findAll(const std::string& word) const {
  std::vector<const Property*> result;
  for (const Item& item : block_->items) {
    if (item.property && item.property->word == word) result.push_back(&*item.property);
  }
  return result;
}

double CheckedBlock::number(const std::string& word, double fallback) const {
  const std::vector<double> found = numbers(word, {});
  return found.empty() ? fallback : found.front();
}

bool CheckedBlock::flag(const std::string& word, bool fallback) const {
  const Property* property = find(word);
  return property == nullptr || property->values.empty() ? fallback : property->values.front().text == "on";
}

std::vector<double> CheckedBlock::numbers(const std::string& word, std::vector<double> fallback) const {
  const Property* property = find(word);
  if (property == nullptr) return fallback;
  std::vector<double> result = numbersInBaseUnits(*property);
  const Header header = headerOf(*block_, *specification_);
  for (const PropertySpecification* one :
       propertiesOf(*specification_, header.kind != nullptr ? header.kind->text : "")) {
    if (one->word == word && one->type == PropertyType::oneOrThree && result.size() == 1)
      result.resize(3, result[0]);
  }
  return result;
}

std::string CheckedBlock::text(const std::string& word, std::string fallback) const {
  const Property* property = find(word);
  return property == nullptr || property->values.empty() ? fallback : property->values.front().text;
}

std::vector<double> numbersInBaseUnits(const Property& property) {
  std::vector<const Value*> values;
  const std::function<void(const std::vector<Value>&)> collect = [&](const std::vector<Value>& all) {
    for (const Value& value : all) {
      if (value.kind == ValueKind::number) values.push_back(&value);
      if (value.kind == ValueKind::list || value.kind == ValueKind::range) collect(value.items);
    }
  };
  collect(property.values);
  // A unit behind the last component alone holds for all, but not for an axis before an angle.
  const bool lastOnly = !values.empty() && values.back()->unit &&
                        std::none_of(values.begin(), values.end() - 1,
                                     [](const Value* value) { return value->unit.has_value(); });
  constexpr std::size_t kAxisAndNumber = 4;
  const bool shared = lastOnly && values.size() < kAxisAndNumber && property.values.size() > 1;
  std::vector<double> result;
  for (const Value* value : values) {
    result.push_back(shared ? value->number * values.back()->unit->toBase : value->inBaseUnits());
  }
  return result;
}

}  // namespace lumivox::dsl
