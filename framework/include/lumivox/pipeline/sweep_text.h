// Sweep texts: which scenes, pipelines, parameters and seeds are measured against each other.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "lumivox/pipeline/pipeline.h"

namespace lumivox {

/// Words of a sweep block that no parameter of a pipeline can have as its name.
inline constexpr const char* kSweptScenes = "scenes";
inline constexpr const char* kSweptPipelines = "pipelines";
inline constexpr const char* kSweptSeeds = "seeds";

/// One value of an axis, and where it is written.
struct SweepValue {
  ParameterValue value;
  SourcePlace place;
  int length = 1;  ///< columns
};
struct SweepAxis {
  std::string parameter;
  SourcePlace place;
  std::vector<SweepValue> values;
};

/// A sweep block as it is written, before any pipeline has said what parameters it has.
struct SweepBlock {
  std::string name;
  SourcePlace place;
  bool isList = false;
  std::vector<SweepAxis> axes;
  std::vector<std::uint64_t> seeds;
  std::vector<std::filesystem::path> scenes,
      pipelines;  ///< as found from the text; none in a pipeline's text
};

/// A text of sweep blocks alone, `*.sweep`.
struct SweepText {
  std::filesystem::path file;
  std::vector<SweepBlock> sweeps;
  std::shared_ptr<const dsl::Document> document;

  /// Throws DiagnosticsError with every finding, files that are not there among them.
  static SweepText load(const std::filesystem::path& file);
  static SweepText parse(std::string source, std::filesystem::path file);
};

/// One pipeline's share of a sweep block.
struct SweepShare {
  std::size_t block = 0;  ///< in SweepText::sweeps
  std::shared_ptr<const Pipeline> pipeline;
  Sweep sweep;  ///< the axes whose parameters the pipeline has
};

/// Every block's pipelines, in text order. Throws DiagnosticsError with all findings: those of the pipelines,
/// a value that does not fit its parameter, a parameter that no pipeline of the block has. `notes` names each
/// pipeline that lacks an axis.
std::vector<SweepShare> sweepShares(const SweepText& text, TechniqueSource& techniques,
                                    std::vector<std::string>& notes);

/// Tables of the sweep texts, for describe and the reference.
const std::vector<dsl::BlockSpecification>& sweepSpecifications();

}  // namespace lumivox
