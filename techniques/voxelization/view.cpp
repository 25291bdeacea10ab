// The voxels of any voxelizer as an image, to look at.
#include "bits/bit_voxelizer.h"

namespace lumivox::voxelization {

using namespace shaders::voxelization;

namespace {

class ViewPass : public Pass {
  In<VoxelFragments> fragments{this, "fragments", "voxels"};
  Param<float> cut{this, "cut",
                   0.0f, within(0.0f, 1e9f),
                   "m",  "distance in front of the camera up to which voxels are cut away"};
  Out<Image> image{this, "image", "the voxels as shaded cubes: an image to look at, not light"};

  Reads readsFrom() const override { return Reads::camera; }

  void run(PassContext& frame) override {
    const GridPlacement& grid = fragments->grid;
    const gpu::TextureRef words = bitsOf(frame, *fragments, "bits");
    const CameraView& camera = frame.snapshot().camera;
    image = Image{frame.image("image of voxels"), false};
    frame.dispatch(
        frame.program(view::kProgram),
        {view::parameters({.eyeGrid = (camera.eye - grid.low) / grid.voxelSize,
                           .pixelWidth = 2.0f * camera.tanHalfFov / static_cast<float>(camera.height),
                           .right = camera.right,
                           .imageWidth = static_cast<float>(camera.width),
                           .up = camera.up,
                           .imageHeight = static_cast<float>(camera.height),
                           .forward = camera.forward,
                           .cut = cut / grid.voxelSize,
                           .resolution = grid.resolution}),
         view::words(words), view::image(image->texture)},
        pixels(frame));
  }
};

}  // namespace

void addView(TechniqueRegistry& registry) {
  registry.add<ViewPass>("view", "The voxels of any voxelizer, drawn as cubes");
}

}  // namespace lumivox::voxelization
