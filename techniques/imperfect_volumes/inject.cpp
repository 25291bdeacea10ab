// Injects direct light into the volume: Mavridis & Papaioannou 2011, Sec. 3.1 and 3.2.
#include "lumivox/toolkit/light_bounds.h"
#include "lumivox/toolkit/voxel_slots.h"
#include "volume.h"

namespace lumivox::imperfect_volumes {

using namespace shaders::imperfect_volumes;

namespace {

// Half floats end at 65504; two bands of two sides of the brightest radiance reach 2 pi Y0 * 2 of it.
constexpr float kLargestHalf = 32768.0f, kLargestCoefficient = 4.0f;

class InjectPass : public Pass {
  enum class Lobe { hemisphere, cosine };
  enum class Precision { float_, half };
  enum class Lobes { diffuse, none };

  In<VoxelFragments> fragments{this, "fragments", "surface samples: the imperfect volume"};
  In<ShadowMap> shadow{
      this, "shadow", Presence::optional,
      "lights and their visibility; without it only the environment and direct light stored in fragments are injected"};
  Param<Lobe> lobe{
      this, "lobe", Lobe::hemisphere,
      "radiance of the lit side of a surface; hemisphere: the same over its half space, as of a Lambert surface; cosine: a clamped cosine of the same flux. The paper does not say which"};
  Param<Lobes> lobes{
      this, "lobes", Lobes::diffuse,
      "what Phong lobes reflect of the lights; diffuse: all of it, as if it left to all sides; none: nothing, since the paper's surfaces are diffuse",
      published(Lobes::none)};
  Param<Precision> precision{this, "precision", Precision::float_,
                             "numbers in the volume; float: 48 bytes a voxel; half: 24"};
  Out<ShGrid> reflected{this, "reflected", Contributes::nothing, Needs::anyLight,
                        "direct light that the surfaces of each voxel reflect"};

  std::uint64_t room_ = 0;  ///< number of slots: a guess, or what earlier frames needed

  // The bound of what voxels reflect follows from lights and emitters.
  Reads readsFrom() const override { return Reads::geometry | Reads::materials | Reads::lights; }

  void run(PassContext& frame) override {
    const GridPlacement& grid = fragments->grid;
    const bool half = precision == Precision::half;
    // A voxel does not resolve anything nearer than half its side.
    const float most = largestRadiance(frame.sceneDescription(), frame.snapshot(), 0.5f * grid.voxelSize);
    ShGrid result;
    result.quantity = ShGrid::Quantity::radiance;
    if (half) result.unit = most * kLargestCoefficient / kLargestHalf;
    result.levels.push_back({grid, coefficientVolumes(frame, grid.resolution, "reflected radiance",
                                                      half ? gpu::Format::rgba16f : gpu::Format::rgba32f)});
    for (const gpu::TextureRef& volume : result.levels.front().coefficients) volume->clear(glm::vec4(0.0f));
    reflected = result;
    const LightBinding lights(shadow);
    if (lights.count > 0 || fragments->reflected != nullptr) fill(frame, result, lights, most, half);
  }

  void fill(PassContext& frame, const ShGrid& result, const LightBinding& lights, float most, bool half) {
    const GridPlacement& grid = fragments->grid;
    const VoxelSlots slots = claimSlots(frame, *fragments, room_);
    const gpu::BufferRef radiances = frame.elements(inject_light::radiances, 6 * fragments->capacity,
                                                    "radiance that fragments reflect"),
                         brightest =
                             frame.emptyElements(inject_light::brightest, slots.room, "brightest of slots"),
                         sums = frame.emptyElements(inject_add::sums, slots.room, "sums of slots");
    const inject_light::Variant lighting{.lights = lights.count > 0,
                                         .reflected = fragments->reflected != nullptr};
    forEachFragment(frame, frame.program(lighting),
                    {inject_light::lighting({.gridLow = grid.low,
                                             .voxelSize = grid.voxelSize,
                                             .lightCount = lights.count,
                                             .mostRadiance = most,
                                             .glossy = lobes == Lobes::diffuse && frame.traits().glossy}),
                     inject_light::radiances(radiances), inject_light::brightest(brightest),
                     SlotBinding(slots), inject_light::reflected(fragments->reflected), lights},
                    *fragments);
    const shader::BindingSet summed{inject_add::sums(sums), inject_add::brightest(brightest)};
    forEachFragment(frame, frame.program(inject_add::kProgram),
                    {summed, inject_add::radiances(radiances), SlotBinding(slots)}, *fragments);
    const inject_resolve::Variant variant{half ? inject_resolve::Variant::precisionHalf
                                               : inject_resolve::Variant::precisionFloat};
    forEachSlot(frame, frame.program(variant, inject_resolve::Constants{.cosineLobe = lobe == Lobe::cosine}),
                {summed, inject_resolve::resolving({.unit = result.unit}),
                 images(result.levels.front().coefficients)},
                slots);
  }
};

}  // namespace

void addInject(TechniqueRegistry& registry) {
  registry.add<InjectPass>(
      "inject",
      "Direct light that surfaces reflect, into the volume (Mavridis & Papaioannou 2011, Sec. 3.1)");
}

}  // namespace lumivox::imperfect_volumes
