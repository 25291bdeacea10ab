#include <fmt/format.h>

#include <algorithm>

#include "lumivox/base/file.h"
#include "lumivox/dsl/document.h"

namespace lumivox::dsl {
namespace {

namespace fs = std::filesystem;

fs::path identityOf(const fs::path& file) {
  std::error_code error;
  fs::path result = fs::weakly_canonical(file, error);
  return error ? file.lexically_normal() : result;
}

/// Splices the items of included files in place of `include "file"`, depth first. `chain` holds the files
/// that are being read.
class Splicer {
 public:
  explicit Splicer(Document& document) : root_(document) {}

  void run() { splice(root_.items, root_.file); }

 private:
  void splice(std::vector<Item>& items, const fs::path& file) {
    chain_.push_back(identityOf(file));
    std::vector<Item> result;
    for (Item& item : items) {
      if (item.block) splice(*item.block, file);
      if (item.property && item.property->word == "include") {
        include(*item.property, file, result);
      } else {
        result.push_back(std::move(item));
      }
    }
    items = std::move(result);
    chain_.pop_back();
  }

  void splice(Block& block, const fs::path& file) {
    std::vector<Item> result;
    for (Item& item : block.items) {
      if (item.block) splice(*item.block, file);
      if (item.property && item.property->word == "include") {
        include(*item.property, file, result);
      } else {
        result.push_back(std::move(item));
      }
    }
    block.items = std::move(result);
  }

  void report(const Property& property, std::string what, std::string expected) {
    const bool hasValue = !property.values.empty();
    root_.findings.push_back(root_.finding(hasValue ? property.values.front().place : property.place,
                                           hasValue ? property.values.front().length : 7, std::move(what),
                                           std::move(expected)));
  }

  void include(const Property& property, const fs::path& file, std::vector<Item>& result) {
    if (property.values.size() != 1 || property.values.front().kind != ValueKind::text) {
      return report(property, "'include' without a file", "one file name in double quotes");
    }
    const fs::path target = (file.parent_path() / property.values.front().text).lexically_normal();
    const fs::path identity = identityOf(target);
    if (const auto seen = std::find(chain_.begin(), chain_.end(), identity); seen != chain_.end()) {
      std::string cycle;
      for (auto step = seen; step != chain_.end(); ++step) cycle += step->filename().string() + " -> ";
      return report(property, fmt::format("include cycle: {}{}", cycle, identity.filename().string()),
                    "a file that does not include this one");
    }
    if (++count_ > kMaximumIncludes) {
      if (count_ == kMaximumIncludes + 1) {
        report(property, "too many included files", fmt::format("at most {}", kMaximumIncludes));
      }
      return;
    }
    std::error_code error;
    if (!fs::exists(target, error)) {
      return report(property, fmt::format("included file '{}' does not exist", target.string()),
                    "a path relative to the including file");
    }
    std::string source;
    try {
      source = readFile(target, kMaximumTextBytes);
    } catch (const Error& failure) {
      return report(property, fmt::format("cannot include: {}", failure.what()), "a readable text file");
    }
    Document part = parse(std::move(source), target);
    if (std::find(root_.includedFiles.begin(), root_.includedFiles.end(), target) ==
        root_.includedFiles.end()) {
      root_.includedFiles.push_back(target);
      root_.includedSources[target.string()] = part.source;
      root_.includedLineStarts[target.string()] = part.lineStarts;
      for (Diagnostic& finding : part.findings) root_.findings.push_back(std::move(finding));
    }
    splice(part.items, target);
    std::move(part.items.begin(), part.items.end(), std::back_inserter(result));
  }

  Document& root_;
  std::vector<fs::path> chain_;
  std::size_t count_ = 0;
};

}  // namespace

void resolveIncludes(Document& document) {
  Splicer(document).run();
}

Document parseFile(const std::filesystem::path& file) {
  Document document = parse(readFile(file, kMaximumTextBytes), file);
  resolveIncludes(document);
  return document;
}

}  // namespace lumivox::dsl
