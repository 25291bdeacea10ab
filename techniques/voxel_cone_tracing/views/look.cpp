// Shows a grid: casts rays and cones through the voxels of any kind of port, with a transfer function (thesis
// Gomes 2015, Sec. 2.3).
#include <fmt/format.h>

#include <algorithm>

#include "lumivox/base/error.h"
#include "lumivox/plugin/technique.h"
#include "lumivox/toolkit/bindings.h"
#include "lumivox/toolkit/voxel_view.h"
#include "voxel_cone_tracing_shaders.h"

namespace lumivox::voxel_cone_tracing {
namespace {

using namespace shaders::voxel_cone_tracing;
using gpu::Sampling;
using Field = PortContents::Field;

class LookPass : public Pass {
  // In the order of look_march.comp.
  enum class Emission { colours, ramp };
  enum class Opacity { automatic, field, absorption, solid };
  enum class Filter { nearest, trilinear };
  enum class Cast { ray, cone };
  enum class Faces { off, on, edges };  // in the order of VoxelLook::Shading

  InVoxels voxels{this, "voxels", "the grid: an output of any kind that is exported"};
  Param<int> field{this, "field", 0, within(0, 99),
                   "number of the field, in the order of 'vdbexport --list'"};
  Param<int> level{this, "level", 0, within(0, 31),
                   "level of the grid; 0: the finest, or the smallest of nested grids"};
  Param<Emission> emission{
      this, "emission", Emission::colours,
      "emission of voxels; colours: the value itself; ramp: a colour from black over blue, green and yellow to white"};
  Param<float> low{this, "low", 0.0f, within(-1e9f, 1e9f), "value at the lower end of the ramp"};
  Param<float> high{this, "high", 1.0f, within(-1e9f, 1e9f), "value at the upper end of the ramp"};
  Param<Opacity> opacity{
      this, "opacity", Opacity::automatic,
      "opacity of a voxel; field: the kind's own field of opacity; absorption: by the value times 'absorption'; solid: opaque where the value is not 0; automatic: the first of these that the kind has"};
  Param<float> absorption{this, "absorption", 1.0f, within(0.0f, 1e9f), "/m", "extinction at the value 1"};
  Param<bool> multiplied{this, "multiplied", false,
                         "values are already multiplied by the opacity, as radiance is"};
  Param<float> gain{this, "gain", 1.0f, within(0.0f, 1e9f), "factor of the emission"};
  Param<Filter> filter{
      this, "filter", Filter::nearest,
      "reading of cells; nearest: as they are; trilinear: interpolated between their centres"};
  Param<Cast> cast{
      this, "cast", Cast::ray,
      "ray: through the centre of each pixel; cone: through the whole pixel, by means over voxels as large as the pixel is there"};
  Param<Faces> faces{
      this, "faces", Faces::off,
      "whether nearest cells are shaded by the face that is seen, so that each stands out, and have darker edges, too"};
  Param<float> cut{this, "cut",
                   0.0f, within(0.0f, 1e9f),
                   "m",  "distance before the camera up to which everything is cut away"};
  Param<float> step{this, "step", 0.5f, within(0.05f, 2.0f),
                    "step as a share of a voxel; with 'filter nearest' the march goes from cell to cell"};
  Param<float> background{this, "background", 0.0f, within(0.0f, 1e9f), "radiance behind the grid"};
  Out<Image> radiance{this, "radiance", "the grid as the camera sees it"};

  Reads readsFrom() const override { return Reads::camera; }
  std::string checkParameters() const override {
    return low < high ? "" : "'low' is not below 'high', the ends of the ramp";
  }

  const Field& chosen(const std::vector<const Field*>& fields) const {
    if (field < static_cast<int>(fields.size())) return *fields[static_cast<std::size_t>(field)];
    std::vector<std::string> names;
    for (std::size_t i = 0; i < fields.size(); ++i)
      names.push_back(fmt::format("{} ({})", i, fields[i]->name));
    throw Error(fmt::format("'voxels' has no field {}; expected {}", static_cast<int>(field),
                            fmt::join(names, ", ")));
  }

  /// The default is the first that the kind has: an absorbing density, a field of opacity, or all that is not
  /// 0.
  VoxelTransfer::Rule ruleFor(const Field& shown, const std::vector<const Field*>& fields,
                              const PortKind& kind) const {
    VoxelTransfer::Rule rule{.absorption = absorption, .multiplied = multiplied};
    if (emission == Emission::ramp) {
      rule.rampLow = low;
      rule.rampHigh = high;
    }
    const auto fog = std::find_if(fields.begin(), fields.end(),
                                  [](const Field* one) { return one->what->role == PortField::Role::fog; });
    const bool isDensity = shown.what->role == PortField::Role::density;
    if (opacity == Opacity::absorption || (opacity == Opacity::automatic && isDensity)) {
      rule.opacity = VoxelTransfer::Opacity::absorption;
    } else if (opacity == Opacity::field || (opacity == Opacity::automatic && fog != fields.end())) {
      if (fog == fields.end())
        throw Error(fmt::format(
            "'opacity field': a {} has no field of opacity; expected 'opacity absorption' or 'opacity solid'",
            kind.name));
      rule.opacity = VoxelTransfer::Opacity::field;
      rule.opacityField = *fog;
    }
    return rule;
  }

  void run(PassContext& frame) override {
    const PortContents contents = voxels.contents();
    const std::vector<const Field*> fields = fieldsOfLevel(contents, level);
    const Field& shown = chosen(fields);
    const VoxelCanvas canvas(frame);
    const VoxelTransfer transfer(canvas, shown, ruleFor(shown, fields, contents.kind()));
    const CameraView& camera = frame.snapshot().camera;
    const VoxelLook look{.cut = cut,
                         .shading = static_cast<VoxelLook::Shading>(static_cast<Faces>(faces)),
                         .gain = gain,
                         .background = background};
    const bool fromCellToCell = filter == Filter::nearest && cast == Cast::ray;
    radiance =
        Image{fromCellToCell ? blendedVoxels(canvas, camera, transfer, look) : marched(frame, transfer, look),
              shown.unit == kRadianceUnit};
  }

  /// Marches in steps through the emission and opacity of voxels; cones march through their means.
  gpu::TextureRef marched(PassContext& frame, const VoxelTransfer& transfer, const VoxelLook& look) const {
    const glm::ivec3& size = transfer.values().resolution();
    const int levels = cast == Cast::cone ? gpu::fullLevelCount(size.x, size.y, size.z) : 1;
    const gpu::TextureRef classified =
        frame.volume(size, gpu::Format::rgba32f, "voxels that emit and absorb", levels);
    frame.dispatch(frame.program(look_classify::Variant{.opacity = transfer.opacity(),
                                                        .source = transfer.values().source()}),
                   {transfer.bindings(), look_classify::classified(classified, 0)}, size);
    for (int i = 1; i < levels; ++i) {
      const glm::ivec3 coarse = levelResolution(size, i);
      frame.dispatch(
          frame.program(look_mean::kProgram),
          {look_mean::mean({.coarse = coarse, .fineLevel = i - 1, .fine = levelResolution(size, i - 1)}),
           look_mean::classified(classified, Sampling::nearest), look_mean::meanImage(classified, i)},
          coarse);
    }
    gpu::TextureRef image = frame.image("voxels");
    frame.dispatch(
        frame.program(look_march::Variant{},
                      look_march::Constants{.filterRule = static_cast<int>(static_cast<Filter>(filter)),
                                            .castsCones = cast == Cast::cone}),
        {transfer.bindings(), look.rays(frame.snapshot().camera),
         look_march::march({step, static_cast<float>(levels - 1)}),
         look_march::classified(classified,
                                filter == Filter::nearest ? Sampling::nearest : Sampling::linearMips),
         look_march::radianceImage(image)},
        pixels(frame));
    return image;
  }
};

}  // namespace

void addLook(TechniqueRegistry& registry) {
  registry.add<LookPass>(
      "look", "Ray and cone casting of any grid's voxels with a transfer function (thesis Sec. 2.3)");
}

}  // namespace lumivox::voxel_cone_tracing
