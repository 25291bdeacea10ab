// Parameters of single passes, which a pipeline's text may have left at their defaults.
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
  std::string value;   ///< as the text sets it, or the default
  bool bound = false;  ///< a parameter of the pipeline stands for it, or `as_published on` of its pass
};
std::vector<PassParameter> allPassParameters(const Pipeline& pipeline, TechniqueSource& techniques);
/// Those that are not bound.
std::vector<PassParameter> freePassParameters(const Pipeline& pipeline, TechniqueSource& techniques);

/// The same text with these parameters of passes set, by "pass.parameter". Error for an unknown pass.
Pipeline withPassParameters(const Pipeline& pipeline, const ParameterValues& values);

}  // namespace lumivox::stress
