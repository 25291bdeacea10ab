// Parameters of single passes, also those that a pipeline's text leaves at their defaults.
#pragma once

#include <string>
#include <vector>

#include "lumivox/pipeline/pass.h"
#include "lumivox/pipeline/pipeline.h"

namespace lumivox::stress {

/// A parameter of a pass.
struct PassParameter {
  std::string name;  ///< "gather.cones"
  ParamBase::Type type;
  double low = 0.0, high = 0.0;  ///< of numbers
  std::vector<std::string> words;
  std::string value;   ///< set by the text, or the default
  bool bound = false;  ///< set by a parameter of the pipeline, or by `as_published on` of its pass
};
std::vector<PassParameter> allPassParameters(const Pipeline& pipeline, TechniqueSource& techniques);
/// The parameters that are not bound.
std::vector<PassParameter> freePassParameters(const Pipeline& pipeline, TechniqueSource& techniques);

/// The same text with these pass parameters set, by "pass.parameter". Error for an unknown pass.
Pipeline withPassParameters(const Pipeline& pipeline, const ParameterValues& values);

}  // namespace lumivox::stress
