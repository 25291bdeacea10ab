// Common parts of the readers of pipelines, sweeps and published tables, and of binding.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lumivox/pipeline/pipeline.h"

namespace lumivox {

/// The part of a reader that collects findings.
class TextFindings {
 protected:
  TextFindings(const dsl::Document& document, std::vector<Diagnostic>& findings)
      : document_(document), findings_(findings) {}
  void report(const SourcePlace& place, int length, std::string what, std::string expected = {},
              std::string suggestion = {});
  /// Reports a finding that underlines the whole word.
  void report(const SourcePlace& place, const std::string& word, std::string what, std::string expected = {},
              std::string suggestion = {});

  const dsl::Document& document_;
  std::vector<Diagnostic>& findings_;
};

/// The path of a file that a value names, relative to the text that contains the value; an included text has
/// its own folder.
std::filesystem::path besideText(const dsl::Value& value);

/// "a.b" as (a, b); nothing for any other value.
std::optional<std::pair<std::string, std::string>> splitDotted(const dsl::Value& value);
/// A number, word or string as the value of a parameter; nothing for any other value.
std::optional<ParameterValue> parameterValue(const dsl::Value& value);
/// LOW..HIGH with numbers at both ends.
bool isNumberRange(const dsl::Value& value);
const PipelineParameter* findParameter(const Pipeline& pipeline, const std::string& name);
std::vector<std::string> parameterNames(const Pipeline& pipeline);
/// "one of a, b, c", or `otherwise` when there are none.
std::string oneOf(const std::vector<std::string>& words, const std::string& otherwise);
/// "must be in 1..2" as the expectation of a diagnostic: "in 1..2".
std::string misfitExpectation(const std::string& misfit);
/// Throws all findings when there is an error among them, else logs the warnings.
void throwOrLog(std::vector<Diagnostic> findings);

}  // namespace lumivox
