// `lumivox describe WORD --json`: the meanings of a word as JSON.
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

/// The port kinds of the framework and of the techniques. `passes` keeps the latter alive.
std::vector<const PortKind*> portKinds(TechniqueSet& techniques, std::vector<std::unique_ptr<Pass>>& passes);

/// Every use of the word: `what` it is (block, property, port kind, technique, pass, input, output or
/// parameter), its meaning and its values. Numbers are in base units, named by `unit` (m, s, rad, /m, ...).
Json describedAsJson(TechniqueSet& techniques, const std::string& word);

}  // namespace lumivox::command
