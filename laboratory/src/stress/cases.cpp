// Joins all families of cases.
#include "stress/cases.h"

#include <iterator>

namespace lumivox::stress {

std::vector<Case> casesFor(const Pipeline& pipeline, TechniqueSource& techniques) {
  std::vector<Case> all;
  const auto add = [&](std::vector<Case> family) {
    all.insert(all.end(), std::make_move_iterator(family.begin()), std::make_move_iterator(family.end()));
  };
  add(stiffTransportCases());
  add(geometryCases());
  add(scaleAndPlaceCases());
  add(lightCases());
  add(imageAndCameraCases());
  add(timeCases());
  add(refinementCases(pipeline));
  add(repeatabilityCases());
  add(parameterCases(pipeline, techniques));
  return all;
}

}  // namespace lumivox::stress
