#include "orthogonal_view.h"

#include <algorithm>

namespace lumivox::voxelization {

// The programs of all views bind the same things at the same places.
namespace viewShader = shaders::voxelization::slicing;

int viewSide(const GridPlacement& grid) {
  return std::max({grid.resolution.x, grid.resolution.y, grid.resolution.z});
}

OrthogonalView viewAlong(const VoxelFragments& list, int axis, float depthLow, float depthHigh) {
  OrthogonalView view{};
  view.gridLow = list.grid.low;
  view.voxelSize = list.grid.voxelSize;
  view.resolution = list.grid.resolution;
  view.capacity = static_cast<int>(list.capacity);
  view.side = static_cast<float>(viewSide(list.grid));
  view.axis = axis;
  view.depthLow = depthLow;
  view.depthHigh = depthHigh;
  return view;
}

std::vector<gpu::ResourceBinding> viewBindings(PassContext& frame, const OrthogonalView& view,
                                               const SceneDraw& draw) {
  GpuScene& scene = frame.scene();
  const gpu::Texture& diffuse = draw.diffuseTexture != nullptr ? *draw.diffuseTexture : scene.whiteTexture();
  const gpu::Texture& mask = draw.maskTexture != nullptr ? *draw.maskTexture : scene.whiteTexture();
  return {viewShader::positions(scene.positions()),
          viewShader::normals(scene.normals()),
          viewShader::texcoords(scene.texcoords()),
          viewShader::objects(scene.objects()),
          viewShader::materials(scene.materials()),
          viewShader::view(view),
          viewShader::draw({draw.object, draw.material}),
          viewShader::diffuseTexture(diffuse, gpu::Sampling::linearMipsRepeat),
          viewShader::maskTexture(mask, gpu::Sampling::linearMipsRepeat)};
}

}  // namespace lumivox::voxelization
