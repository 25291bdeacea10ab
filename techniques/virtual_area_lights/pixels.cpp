// Points at pixels in place of points spread in advance, for surfaces of which no triangles are known, such
// as those that a depth camera sees; and points as discs that occlude others.
#include "lumivox/base/error.h"
#include "lumivox/toolkit/bindings.h"
#include "passes.h"
#include "sparse_texture.h"
#include "virtual_area_lights_shaders.h"

namespace lumivox::virtual_area_lights {
namespace {

using namespace shaders::virtual_area_lights;

/// The block PixelPoints of pixel_points.glsl, of a program's own type.
template <class Block>
Block pixelPointsOf(const SurfacePoints& points) {
  return {points.pixels, points.stride};
}

class PixelsPass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "surfaces"};
  Param<int> stride{this, "stride", 8, within(1, 64), "a point at every so many pixels along x and y"};
  Out<SurfacePoints> points{this, "points", "points at pixels: without a grid, for apply_pixels"};

  Reads readsFrom() const override { return Reads::camera; }

  void run(PassContext& frame) override {
    const gpu::TextureDescription& seen = gbuffer->position->description();
    const auto across = [&](int size) { return (size + stride - 1) / stride; };
    SurfacePoints result;
    result.pixels = {across(seen.width), across(seen.height)};
    result.stride = stride;
    result.count = result.pixels.x * result.pixels.y;
    result.position = sparseTexture(frame, result, "positions of pixels");
    result.normal = sparseTexture(frame, result, "normals of pixels");
    result.radius = sparseTexture(frame, result, "radii of pixels");
    const CameraView& view = frame.snapshot().camera;
    forEachPoint(
        frame, frame.program(points_at_pixels::kProgram),
        {points_at_pixels::parameters({.eyeWorld = view.eye,
                                       .pixelWidth = 2.0f * view.tanHalfFov / static_cast<float>(seen.height),
                                       .forward = view.forward}),
         points_at_pixels::pixelPoints(pixelPointsOf<points_at_pixels::PixelPoints>(result)),
         GBufferBinding(*gbuffer), points_at_pixels::positionImage(result.position),
         points_at_pixels::normalImage(result.normal), points_at_pixels::radiusImage(result.radius)},
        result);
    points = result;
  }
};

class ApplyPixelsPass : public Pass {
  In<GBuffer> gbuffer{this, "gbuffer", "the surfaces whose pixels the points are"};
  In<SurfacePoints> points{this, "points", "points at pixels, by pixels"};
  In<SparseLight> light{this, "light", "light that the points reflect, by gather or occlude, not normalised"};
  Out<Image> diffuse{this, "diffuse", Contributes::indirectDiffuse, Needs::anyLight,
                     "indirect light reflected by the diffuse lobe, W/(sr m^2)"};

  Reads readsFrom() const override { return Reads::camera; }

  void run(PassContext& frame) override {
    if (points->stride == 0)
      throw Error(
          "virtual_area_lights.apply_pixels: 'points' are spread over triangles; expected points at pixels, by "
          "virtual_area_lights.pixels");
    using gpu::Sampling;
    diffuse = Image{frame.image("diffuse light of points at pixels")};
    frame.dispatch(
        frame.program(apply_pixels::kProgram),
        {apply_pixels::pixelPoints(pixelPointsOf<apply_pixels::PixelPoints>(*points)),
         GBufferBinding(*gbuffer), apply_pixels::pointPosition(points->position, Sampling::nearest),
         apply_pixels::pointNormal(points->normal, Sampling::nearest),
         apply_pixels::pointRadius(points->radius, Sampling::nearest),
         apply_pixels::diffuseLight(light->diffuse, Sampling::nearest),
         apply_pixels::diffuseImage(diffuse->texture)},
        pixels(frame));
  }
};

class DiscsPass : public Pass {
  In<SurfacePoints> points{this, "points", "points on surfaces"};
  Out<SurfaceLights> discs{this, "discs", "their discs, without flux: they occlude other points"};

  void run(PassContext& frame) override {
    const SurfaceLights result{
        frame.emptyElements(point_discs::discs, static_cast<std::uint64_t>(points->count), "discs of points"),
        points->count};
    forEachPoint(frame, frame.program(point_discs::kProgram),
                 {SurfacePointsBinding(*points), point_discs::discs(result.lights)}, *points);
    discs = result;
  }
};

}  // namespace

void addPixels(TechniqueRegistry& registry) {
  registry.add<PixelsPass>("pixels", "Points at every few pixels of any g-buffer, found anew in each frame");
  registry.add<ApplyPixelsPass>("apply_pixels", "Light of points at pixels, interpolated to all pixels");
  registry.add<DiscsPass>("discs", "Points as discs that occlude others");
}

}  // namespace lumivox::virtual_area_lights
