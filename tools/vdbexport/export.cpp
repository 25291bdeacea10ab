#include "vdbexport/export.h"

#include <fmt/format.h>
#include <openvdb/math/Maps.h>

#include <algorithm>
#include <set>

#include "lumivox/base/error.h"
#include "lumivox/base/log.h"

namespace lumivox::vdb {
namespace {

/// Options by which only the passes run that a grid needs.
RenderOptions gridsAlone(RenderOptions options) {
  options.wantsOutputs = false;
  return options;
}

bool isExportable(const PortKind& kind) {
  return !kind.fields.empty();
}

/// "VoxelFragments, OccupancyGrid": the framework's kinds that can be exported, and those of the pipeline.
std::string exportableText(const Pipeline& pipeline, const PipelineExecutor& executor) {
  std::vector<std::string> names;
  const auto add = [&](const PortKind& kind) {
    if (isExportable(kind) && std::find(names.begin(), names.end(), kind.name) == names.end())
      names.push_back(kind.name);
  };
  for (const PortKind* kind : FrameworkPorts::kinds()) add(*kind);
  for (const PassText& pass : pipeline.passes)
    for (const OutBase* output : executor.pass(pass.name).outputs()) add(output->kind());
  return fmt::format("{}", fmt::join(names, ", "));
}

const Source& findSource(const std::vector<Source>& sources, const std::string& wanted,
                         const Pipeline& pipeline, const PipelineExecutor& executor) {
  std::vector<std::string> names;
  for (const Source& source : sources) {
    if (source.text() == wanted) return source;
    names.push_back(source.text());
  }
  for (const PassText& pass : pipeline.passes)
    for (const OutBase* output : executor.pass(pass.name).outputs())
      if (wanted == pass.name + "." + output->name())
        throw Error(fmt::format("--grid '{}': is of kind {}; expected one of the kinds {}", wanted,
                                output->kind().name, exportableText(pipeline, executor)));
  const std::string nearest = nearestWord(wanted, names);
  throw Error(fmt::format("--grid '{}': no output PASS.PORT of {}; expected {}{}", wanted,
                          pipeline.file.string(),
                          names.empty() ? "a pipeline with grids, this one has none"
                                        : fmt::format("one of {}", fmt::join(names, ", ")),
                          nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
}

/// OpenVDB's voxels have their centres at whole indices.
openvdb::math::Transform::Ptr transformOf(const Field& field, const glm::dvec3& origin) {
  const glm::dvec3 centre = origin + field.low + 0.5 * field.voxelSize;
  const openvdb::Vec3d translation(centre.x, centre.y, centre.z),
      scale(field.voxelSize.x, field.voxelSize.y, field.voxelSize.z);
  using namespace openvdb::math;
  MapBase::Ptr map;
  if (field.voxelSize == glm::dvec3(field.voxelSize.x))
    map.reset(new UniformScaleTranslateMap(scale.x(), translation));
  else
    map.reset(new ScaleTranslateMap(scale, translation));
  return std::make_shared<Transform>(map);
}

std::string fullName(const Source& source, const Field& field) {
  return fmt::format("{}.{}", source.text(), field.name) +
         (field.level == 0 ? std::string() : fmt::format(".level{}", field.level));
}

/// "levels 0, 1, 2"
std::string levelsText(const std::vector<Field>& fields) {
  std::set<int> levels;
  for (const Field& field : fields) levels.insert(field.level);
  return (levels.size() == 1 ? "level " : "levels ") + fmt::format("{}", fmt::join(levels, ", "));
}

}  // namespace

std::vector<Source> exportableSources(const Pipeline& pipeline, TechniqueSource& techniques) {
  checkPipeline(pipeline, techniques);
  std::vector<Source> sources;
  for (const PassText& text : pipeline.passes)
    for (const PassEntry& entry : techniques.technique(text.technique)->passes) {
      if (entry.name != text.pass) continue;
      const std::unique_ptr<Pass> pass = entry.make();
      for (const OutBase* output : pass->outputs())
        if (isExportable(output->kind()))
          sources.push_back(
              {text.name, output->name(), text.technique, text.pass, output->kind().name, output->meaning()});
    }
  return sources;
}

Exporter::Exporter(gpu::Device& device, TechniqueSource& techniques, const Scene& scene,
                   const Pipeline& pipeline, const RenderOptions& options, ExportRequest request)
    : scene_(scene),
      options_(options),
      request_(std::move(request)),
      executor_(device, techniques, scene, pipeline, gridsAlone(options)) {
  const std::vector<Source> all = exportableSources(pipeline, techniques);
  for (const std::string& wanted : request_.grids) {
    const Source& source = findSource(all, wanted, pipeline, executor_);
    if (std::none_of(sources_.begin(), sources_.end(),
                     [&](const Source& one) { return one.text() == source.text(); }))
      sources_.push_back(source);
  }
  if (request_.grids.empty()) sources_ = all;
  if (sources_.empty())
    throw Error(fmt::format("{}: has no voxel grid to export; expected an output of one of the kinds {}",
                            pipeline.file.string(), exportableText(pipeline, executor_)));
  for (const Source& source : sources_) executor_.keepOutput(source.pass, source.port);
}

const OutBase* Exporter::outputOf(const Source& source) const {
  return executor_.output(source.pass, source.port);
}

std::string Exporter::whyLeftOut(const Source& source) const {
  for (const LeftOut& leftOut : executor_.explain().leftOut)
    if (leftOut.pass == source.pass &&
        (leftOut.level == LeftOut::Level::pass || leftOut.what == source.text()))
      return leftOut.why;
  return "it was left out";
}

/// Keeps one of the outputs that hold the same textures: the one with the most fields, or the last of
/// several.
void Exporter::dropCopies(std::vector<Source>& sources) const {
  const auto isCopy = [&](std::size_t i) {
    const OutBase* output = outputOf(sources[i]);
    if (output == nullptr || output->textures().empty()) return false;
    const std::size_t fields = fieldsOf(*output).size();
    for (std::size_t k = 0; k < sources.size(); ++k) {
      const OutBase* other = k == i ? nullptr : outputOf(sources[k]);
      if (other == nullptr || !other->kind().isSameType(output->kind()) ||
          other->textures() != output->textures())
        continue;
      const std::size_t others = fieldsOf(*other).size();
      if (others > fields || (others == fields && k > i)) {
        logDetails("{} contains the same grid as {}", sources[i].text(), sources[k].text());
        return true;
      }
    }
    return false;
  };
  std::vector<Source> kept;
  for (std::size_t i = 0; i < sources.size(); ++i)
    if (!isCopy(i)) kept.push_back(sources[i]);
  sources = std::move(kept);
}

void Exporter::append(const Source& source, const OutBase& output, std::vector<NamedField>& fields) const {
  const std::vector<Field> all = fieldsOf(output);
  const auto has = [&](int level) {
    return std::any_of(all.begin(), all.end(), [&](const Field& field) { return field.level == level; });
  };
  for (const int level : request_.levels) {
    if (has(level) || all.empty()) continue;
    const std::string text =
        fmt::format("{}: has no level {}; it has {}", source.text(), level, levelsText(all));
    if (!request_.grids.empty()) throw Error(text);
    logInformation("{}", text);
  }
  for (const Field& field : all)
    if (request_.levels.empty() ||
        std::find(request_.levels.begin(), request_.levels.end(), field.level) != request_.levels.end())
      fields.push_back({fullName(source, field), source, field});
}

std::vector<NamedField> Exporter::render(double time, int frame) {
  snapshot_ = snapshotOf(scene_, time, options_.camera, options_.width, options_.height);
  frame_ = frame;
  executor_.render(snapshot_, frame, PipelineExecutor::Images::no);
  std::vector<Source> sources = sources_;
  if (request_.grids.empty()) dropCopies(sources);
  std::vector<NamedField> fields;
  for (const Source& source : sources) {
    const OutBase* output = outputOf(source);
    const std::string why = output == nullptr           ? whyLeftOut(source)
                            : fieldsOf(*output).empty() ? "it contains none"
                                                        : "";
    if (!why.empty()) {
      const std::string text = fmt::format("{}: there is no grid: {}", source.text(), why);
      if (!request_.grids.empty()) throw Error(text);
      logInformation("{}", text);
      continue;
    }
    append(source, *output, fields);
  }
  if (fields.empty())
    throw Error("nothing to export: none of the pipeline's grids has a value on this scene at this level");
  const auto isDensity = [](const NamedField& one) { return one.field.mediumDensity; };
  if (std::count_if(fields.begin(), fields.end(), isDensity) == 1)
    std::find_if(fields.begin(), fields.end(), isDensity)->name = "density";
  return fields;
}

openvdb::GridBase::Ptr Exporter::grid(const NamedField& named,
                                      const std::map<std::string, std::string>& provenance) const {
  const Field& field = named.field;
  const Source& source = named.source;
  openvdb::GridBase::Ptr grid = field.values();
  grid->setName(named.name);
  grid->setTransform(transformOf(field, snapshot_.origin));
  grid->setGridClass(field.gridClass);
  if (field.type == openvdb::typeNameAsString<openvdb::Vec3f>()) grid->setVectorType(field.vectorType);
  grid->setSaveFloatAsHalf(request_.half);
  grid->setCreator("lumivox vdbexport");

  grid->insertMeta(field.constants);
  const auto text = [&](const std::string& name, const std::string& value) {
    grid->insertMeta(name, openvdb::StringMetadata(value));
  };
  for (const auto& [name, value] : provenance) text(name, value);
  text("lumivox.technique", source.technique + "." + source.techniquePass);
  text("lumivox.pass", source.pass);
  text("lumivox.port", source.port);
  text("lumivox.kind", source.portKind);
  text("lumivox.field", field.name);
  text("lumivox.quantity", field.quantity);
  text("lumivox.unit", field.unit);
  text("lumivox.length_unit", "m");
  text("lumivox.voxel_index", "at the voxel's centre");
  for (const ParamBase* parameter : executor_.pass(source.pass).parameters())
    text("lumivox.pass_parameter." + parameter->name(), parameter->valueText());
  grid->insertMeta("lumivox.level", openvdb::Int32Metadata(field.level));
  grid->insertMeta("lumivox.frame", openvdb::Int32Metadata(frame_));
  grid->insertMeta("lumivox.resolution", openvdb::Vec3IMetadata(openvdb::Vec3i(
                                             field.resolution.x, field.resolution.y, field.resolution.z)));
  return grid;
}

}  // namespace lumivox::vdb
