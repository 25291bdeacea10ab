#include "lumivox/reference/voxel_transport.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "lumivox/base/error.h"
#include "lumivox/base/random.h"

namespace lumivox {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// The ray in double precision and the nearest box so far. Embree's single-precision ray only traverses its
/// tree.
struct BoxQuery : RTCIntersectContext {
  glm::dvec3 origin, direction;
  double reach = kInfinite;
  double enter = kInfinite, leave = 0.0;
  BoxStop stop;
  std::uint32_t box = RTC_INVALID_GEOMETRY_ID;
};

void require(RTCDevice device, const char* step) {
  const RTCError error = rtcGetDeviceError(device);
  if (error != RTC_ERROR_NONE)
    throw Error(
        fmt::format("voxel transport: Embree failed to {} (error code {})", step, static_cast<int>(error)));
}

glm::dvec3 cosineAround(const glm::dvec3& normal, RandomStream& random) {
  const double squared = random.uniform(), turn = 2.0 * std::numbers::pi * random.uniform();
  const glm::dvec3 helper = std::abs(normal.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 tangent = glm::normalize(glm::cross(helper, normal)), other = glm::cross(normal, tangent);
  return std::sqrt(squared) * (std::cos(turn) * tangent + std::sin(turn) * other) +
         std::sqrt(1.0 - squared) * normal;
}

}  // namespace

struct VoxelBoxes::Tree {
  std::vector<glm::ivec3> voxels;
  StopWithin stop;
  glm::dvec3 low;
  double size;
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ~Tree() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  glm::dvec3 corner(std::uint32_t box) const { return low + size * glm::dvec3(voxels[box]); }

  static void bounds(const RTCBoundsFunctionArguments* arguments) {
    const auto& self = *static_cast<const Tree*>(arguments->geometryUserPtr);
    const glm::dvec3 low = self.corner(arguments->primID), high = low + self.size;
    // Wider than the rounding of single precision, in which Embree traverses its tree.
    const auto wider = [&](double place) { return 1e-4 * self.size + 1e-6 * std::abs(place); };
    RTCBounds& out = *arguments->bounds_o;
    out.lower_x = static_cast<float>(low.x - wider(low.x)),
    out.upper_x = static_cast<float>(high.x + wider(high.x));
    out.lower_y = static_cast<float>(low.y - wider(low.y)),
    out.upper_y = static_cast<float>(high.y + wider(high.y));
    out.lower_z = static_cast<float>(low.z - wider(low.z)),
    out.upper_z = static_cast<float>(high.z + wider(high.z));
  }

  static void intersect(const RTCIntersectFunctionNArguments* arguments) {
    if (arguments->valid[0] == 0) return;
    const auto& self = *static_cast<const Tree*>(arguments->geometryUserPtr);
    auto& query = *static_cast<BoxQuery*>(arguments->context);
    const glm::dvec3 low = self.corner(arguments->primID), high = low + self.size;
    double enter = 0.0, leave = kInfinite;
    for (int axis = 0; axis < 3; ++axis) {
      const double origin = query.origin[axis], direction = query.direction[axis];
      if (direction == 0.0) {
        if (origin < low[axis] || origin >= high[axis]) return;
        continue;
      }
      const double a = (low[axis] - origin) / direction, b = (high[axis] - origin) / direction;
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    }
    if (!(enter <= leave) || enter > query.reach || enter >= query.enter) return;
    std::optional<BoxStop> stop = BoxStop{enter, glm::dvec3(0.0)};
    if (self.stop)
      stop =
          self.stop({self.voxels[arguments->primID], enter, leave, query.origin, query.direction, enter, {}});
    if (!stop) return;
    query.enter = enter;
    query.leave = leave;
    query.stop = *stop;
    query.box = arguments->primID;
    // Boxes behind this one are skipped, with a margin for rounding.
    auto* ray = RTCRayHitN_RayN(arguments->rayhit, arguments->N);
    RTCRayN_tfar(ray, arguments->N, 0) = std::min(
        RTCRayN_tfar(ray, arguments->N, 0), static_cast<float>(enter * (1.0 + 1e-5) + 1e-3 * self.size));
  }
};

VoxelBoxes::VoxelBoxes(std::span<const glm::ivec3> voxels, const GridPlacement& grid, StopWithin stop)
    : tree_(std::make_unique<Tree>()) {
  tree_->voxels.assign(voxels.begin(), voxels.end());
  tree_->stop = std::move(stop);
  tree_->low = grid.low;
  tree_->size = grid.voxelSize;
  tree_->device = rtcNewDevice(nullptr);
  if (tree_->device == nullptr) throw Error("voxel transport: Embree cannot be started on this processor");
  tree_->scene = rtcNewScene(tree_->device);
  rtcSetSceneFlags(tree_->scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(tree_->device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(voxels.size()));
  rtcSetGeometryUserData(geometry, tree_.get());
  rtcSetGeometryBoundsFunction(geometry, Tree::bounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, Tree::intersect);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(tree_->scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(tree_->scene);
  require(tree_->device, "build the tree over the boxes");
}

VoxelBoxes::~VoxelBoxes() = default;
VoxelBoxes::VoxelBoxes(VoxelBoxes&&) noexcept = default;
VoxelBoxes& VoxelBoxes::operator=(VoxelBoxes&&) noexcept = default;

std::optional<BoxHit> VoxelBoxes::first(const glm::dvec3& origin, const glm::dvec3& direction,
                                        double reach) const {
  BoxQuery query;
  rtcInitIntersectContext(&query);
  query.origin = origin;
  query.direction = direction;
  query.reach = reach;
  RTCRayHit ray{};
  ray.ray.org_x = static_cast<float>(origin.x);
  ray.ray.org_y = static_cast<float>(origin.y);
  ray.ray.org_z = static_cast<float>(origin.z);
  ray.ray.dir_x = static_cast<float>(direction.x);
  ray.ray.dir_y = static_cast<float>(direction.y);
  ray.ray.dir_z = static_cast<float>(direction.z);
  ray.ray.tnear = 0.0f;
  ray.ray.tfar = std::isfinite(reach) ? static_cast<float>(reach * (1.0 + 1e-5) + 1e-3 * tree_->size)
                                      : std::numeric_limits<float>::infinity();
  ray.ray.mask = ~0u;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(tree_->scene, &query, &ray);
  if (query.box == RTC_INVALID_GEOMETRY_ID || query.stop.end > reach) return std::nullopt;
  return BoxHit{tree_->voxels[query.box], query.enter,      query.leave, origin, direction,
                query.stop.end,           query.stop.normal};
}

namespace {

/// The light of one path, and whether its first ray was open.
struct PathResult {
  glm::dvec3 light{0.0};
  bool open = true;
};

PathResult follow(const VoxelBoxes& boxes, BoxStart start, const BoxTransport& transport,
                  RandomStream& random) {
  PathResult result;
  glm::dvec3 throughput(1.0);
  const double reach = transport.reach > 0.0 ? transport.reach : kInfinite;
  for (int bounce = 1; bounce <= transport.bounces; ++bounce) {
    const glm::dvec3 direction = cosineAround(start.normal, random);
    const double looked = bounce == 1 ? std::max(reach, transport.occlusionDistance) : reach;
    const std::optional<BoxHit> hit = boxes.first(start.place, direction, looked);
    if (bounce == 1) result.open = !hit || hit->end > transport.occlusionDistance;
    if (!hit || hit->end > reach) {
      result.light += throughput * transport.environment;
      break;
    }
    result.light += throughput * transport.radiance(*hit);
    if (bounce == transport.bounces) break;
    const BoxSurface surface = transport.surface(*hit);
    throughput *= surface.albedo;
    start = surface.start;
    if (start.normal == glm::dvec3(0.0)) break;
  }
  return result;
}

BoxLight lightAt(const VoxelBoxes& boxes, const BoxStart& start, const BoxTransport& transport,
                 std::uint32_t pixel) {
  BoxLight light;
  if (start.normal == glm::dvec3(0.0)) return light;
  RandomStream random(transport.seed, pixel, 0x626f7865u);
  glm::dvec3 mean(0.0), squares(0.0);
  double open = 0.0;
  for (int i = 0; i < transport.samples; ++i) {
    const PathResult path = follow(boxes, start, transport, random);
    // Welford 1962: the mean and the sum of squares about it.
    const glm::dvec3 off = path.light - mean;
    mean += off / static_cast<double>(i + 1);
    squares += off * (path.light - mean);
    open += path.open;
  }
  const double count = transport.samples;
  light.arriving = mean;
  light.variance = squares / (count * (count - 1.0));
  light.open = open / count;
  light.openVariance = light.open * (1.0 - light.open) / (count - 1.0);
  return light;
}

}  // namespace

std::vector<BoxLight> transportThroughBoxes(const VoxelBoxes& boxes, std::span<const BoxStart> starts,
                                            const BoxTransport& transport) {
  if (transport.samples < 2)
    throw Error(fmt::format("voxel transport: {} samples; expected 2 at least", transport.samples));
  if (!transport.radiance) throw Error("voxel transport: nothing tells the radiance of a box");
  if (transport.bounces > 1 && !transport.surface)
    throw Error(
        fmt::format("voxel transport: {} bounces, and nothing tells how a box reflects", transport.bounces));
  std::vector<BoxLight> result(starts.size());
  tbb::parallel_for(std::size_t{0}, starts.size(), [&](std::size_t i) {
    result[i] = lightAt(boxes, starts[i], transport, static_cast<std::uint32_t>(i));
  });
  return result;
}

}  // namespace lumivox
