// Exports ports of a pipeline as named OpenVDB grids, with their place in the world and their provenance.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "lumivox/pipeline/pipeline.h"
#include "vdbexport/fields.h"

namespace lumivox::vdb {

/// An output of a pass whose port can be exported.
struct Source {
  std::string pass, port;                ///< names in the pipeline's text
  std::string technique, techniquePass;  ///< that produce it
  std::string portKind, meaning;
  std::string text() const { return pass + "." + port; }
};

/// All exportable outputs of a pipeline, in the order of its text. No pass runs.
std::vector<Source> exportableSources(const Pipeline& pipeline, TechniqueSource& techniques);

struct ExportRequest {
  std::vector<std::string> grids;  ///< "PASS.PORT"; empty: everything that can be exported
  std::vector<int> levels = {0};   ///< empty: every level
  bool half = false;               ///< floats are stored with 16 bits
};

/// A field and the name of its grid: PASS.PORT.FIELD, followed by .levelL for a coarser level. The only
/// density of a medium is called "density", which viewers look for.
struct NamedField {
  std::string name;
  Source source;
  Field field;
};

/// Runs the passes that the wanted grids need, and no others.
class Exporter {
 public:
  /// Device, techniques and scene must outlive it. Error for a grid that the pipeline does not have.
  Exporter(gpu::Device& device, TechniqueSource& techniques, const Scene& scene, const Pipeline& pipeline,
           const RenderOptions& options, ExportRequest request);

  /// The fields of one frame. Error if a grid or level that the request names cannot be exported. A request
  /// that names no grids leaves out, with a message, what cannot be exported, and exports one of the outputs
  /// that hold the same textures.
  std::vector<NamedField> render(double time, int frame);

  /// One grid of the last frame, with its transform and metadata. Call it once for each field.
  openvdb::GridBase::Ptr grid(const NamedField& named,
                              const std::map<std::string, std::string>& provenance) const;

 private:
  const OutBase* outputOf(const Source& source) const;
  std::string whyLeftOut(const Source& source) const;
  void append(const Source& source, const OutBase& output, std::vector<NamedField>& fields) const;
  void dropCopies(std::vector<Source>& sources) const;

  const Scene& scene_;
  RenderOptions options_;
  ExportRequest request_;
  PipelineExecutor executor_;
  std::vector<Source> sources_;
  SceneSnapshot snapshot_;
  int frame_ = 0;
};

}  // namespace lumivox::vdb
