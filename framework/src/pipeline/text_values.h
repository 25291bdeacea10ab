// What reading a pipeline text and binding it have in common.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lumivox/pipeline/pipeline.h"

namespace lumivox {

/// "a.b" as (a, b); nothing for any other value.
std::optional<std::pair<std::string, std::string>> splitDotted(const dsl::Value& value);
/// A number, word or string as the value of a parameter; nothing for any other value.
std::optional<ParameterValue> parameterValue(const dsl::Value& value);
const PipelineParameter* findParameter(const Pipeline& pipeline, const std::string& name);
std::vector<std::string> parameterNames(const Pipeline& pipeline);
/// "one of a, b, c", or `otherwise` when there are none.
std::string oneOf(const std::vector<std::string>& words, const std::string& otherwise);
/// "must be in 1..2" as the expectation of a diagnostic: "in 1..2".
std::string misfitExpectation(const std::string& misfit);
/// Throws all findings when there is an error among them, else logs the warnings.
void throwOrLog(std::vector<Diagnostic> findings);

}  // namespace lumivox
