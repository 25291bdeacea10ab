// A pipeline bound to the passes of its techniques, with the source of every input.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lumivox/pipeline/pass.h"
#include "lumivox/pipeline/pipeline.h"

namespace lumivox {

/// An output of a pass, by index; `pass` is -1 when there is none.
struct OutputIndex {
  int pass = -1, port = -1;
  bool valid() const { return pass >= 0; }
  bool operator==(const OutputIndex&) const = default;
};

struct BoundPass {
  std::string name, technique, pass;
  std::unique_ptr<Pass> object;
  std::vector<OutputIndex> sources;  ///< per input of the pass
};

struct BoundOutput {
  std::string name;
  OutputIndex source;
};

struct BoundGraph {
  std::vector<BoundPass> passes;     ///< in text order
  std::vector<BoundOutput> outputs;  ///< in text order
  std::vector<int> order;            ///< indices of passes, sources before readers, text order among equals

  const OutBase& output(OutputIndex index) const {
    return *passes[static_cast<std::size_t>(index.pass)]
                .object->outputs()[static_cast<std::size_t>(index.port)];
  }
  OutBase& output(OutputIndex index) {
    return *passes[static_cast<std::size_t>(index.pass)]
                .object->outputs()[static_cast<std::size_t>(index.port)];
  }
  /// "gather.diffuse"
  std::string outputText(OutputIndex index) const;
  /// Index of a pass. Error with the known names if there is no such pass.
  std::size_t findPass(const std::string& pass) const;
  /// Error with the known names if there is no such pass or port.
  OutputIndex find(const std::string& pass, const std::string& port) const;
};

/// Makes the passes, sets their parameters (`values` over the defaults) and connects them. Throws
/// DiagnosticsError with every finding.
BoundGraph bindPipeline(const Pipeline& pipeline, TechniqueSource& techniques, const ParameterValues& values);

/// Connects the inputs of all passes to their sources.
void connectInputs(BoundGraph& graph);

/// Why a technique is missing, as a finding says it: {what, expected, suggestion}.
struct MissingTechnique {
  std::string what, expected, suggestion;
};
MissingTechnique explainMissing(const TechniqueSource& techniques, const std::string& name);

}  // namespace lumivox
