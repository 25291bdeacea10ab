// A technique that brings a kind of port of its own: radiance in leaves of different sizes.
#include <limits>

#include "lumivox/plugin/technique.h"

namespace own_kind {

struct Leaves {
  lumivox::GridPlacement grid;
  lumivox::gpu::TextureRef table;  ///< a texel a leaf: its radiance
  std::vector<glm::ivec4> cubes;   ///< of each leaf the first voxel and the number along a side
};

}  // namespace own_kind

namespace lumivox {

template <>
struct PortTraits<own_kind::Leaves> {
  static PortKind kind() {
    return {"Leaves",
            "radiance in leaves of different sizes",
            {{"table", "d2 r32f", "radiance of each leaf, W/(sr m^2)"}},
            {{"radiance", "radiance of the leaf", "W/(sr m^2)"}},
            "voxels in leaves that shine"};
  }
  static void contents(const own_kind::Leaves& port, PortContents& contents) {
    contents.texture("table", port.table);
    VoxelsRead leaves;
    leaves.deviceBytes = port.table->sizeBytes();
    leaves.read = [port] {
      std::vector<VoxelsRead::Voxel> voxels;
      const std::vector<float> values = port.table->downloadFloats();
      for (std::size_t i = 0; i < port.cubes.size(); ++i)
        for (int k = 0; k < port.cubes[i].w * port.cubes[i].w * port.cubes[i].w; ++k) {
          const int side = port.cubes[i].w;
          voxels.push_back(
              {glm::ivec3(port.cubes[i]) + glm::ivec3(k % side, k / side % side, k / (side * side)),
               glm::vec3(values[i])});
        }
      return voxels;
    };
    contents.field("radiance", VoxelBox::of(port.grid), leaves);
    contents.occupies(port.grid, leaves);
  }
};

}  // namespace lumivox

namespace {

using namespace lumivox;

enum class Sign { positive, negative };

class Plant : public Pass {
 public:
  Param<Sign> sign{this, "sign", Sign::positive, "of what the second leaf sends"};
  Out<own_kind::Leaves> leaves{this, "leaves", "two of them"};
  void run(PassContext& frame) override {
    own_kind::Leaves made;
    made.grid = {{1.0f, 2.0f, 3.0f}, 0.5f, {4, 4, 4}};
    made.table = frame.texture({gpu::TextureKind::d2, gpu::Format::r32f, 2, 1, 1, 1}, "leaves");
    made.table->uploadFloats(0, std::array{2.0f, sign == Sign::negative ? -3.0f : 3.0f});
    made.cubes = {{0, 0, 0, 2}, {3, 3, 3, 1}};
    leaves = made;
  }
};

class Look : public Pass {
 public:
  In<own_kind::Leaves> leaves{this, "leaves", "that are looked at"};
  Out<Image> radiance{this, "radiance", Contributes::direct};
  void run(PassContext& frame) override {
    const Image image{frame.image("image")};
    image.texture->clear(glm::vec4(leaves->table->downloadFloats().front()));
    radiance = image;
  }
};

}  // namespace

LUMIVOX_TECHNIQUE(registry) {
  registry.describe("brings a kind of port of its own", "no paper");
  registry.add<Plant>("plant", "makes two leaves");
  registry.add<Look>("look", "an image of them");
}
