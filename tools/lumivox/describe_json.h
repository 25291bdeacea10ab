// `lumivox describe WORD --json`: what the tables know of a word, with numbers as numbers.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "command.h"
#include "lumivox/pipeline/pass.h"
#include "lumivox/pipeline/technique_source.h"
#include "lumivox/plugin/loader.h"

namespace lumivox::command {

/// Calls back with every pass of every technique that can be opened.
template <class Visit>
void forEachPass(TechniqueSet& techniques, const Visit& visit) {
  for (const std::string& name : techniques.available())
    if (const Technique* technique = techniques.technique(name))
      for (const PassEntry& entry : technique->passes) visit(*technique, entry);
}

/// The framework's kinds of port, and those that techniques brought, which the passes keep alive.
std::vector<const PortKind*> portKinds(TechniqueSet& techniques, std::vector<std::unique_ptr<Pass>>& passes);

/// Every place of the word: `what` (block, property, port kind, technique, pass, input, output or parameter),
/// its meaning, and what values it takes. Numbers are in base units, which `unit` names (m, s, rad, /m, ...).
Json describedAsJson(TechniqueSet& techniques, const std::string& word);

}  // namespace lumivox::command
