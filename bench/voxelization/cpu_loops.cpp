// Loops over triangles on the CPU, optimised plain C++.
#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <cstring>
#include <glm/gtc/packing.hpp>
#include <thread>

#include "competitors.h"

namespace lumivox::bench {

Mesh meshOf(const Scene& scene, const SceneSnapshot& snapshot, const GridPlacement& grid) {
  Mesh mesh;
  mesh.grid = grid;
  mesh.scene = &scene;
  mesh.normals.resize(scene.positions.size());
  mesh.positions.resize(scene.positions.size());
  mesh.texcoords = scene.texcoords;
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    const Object& object = scene.objects[o];
    const ObjectState& state = snapshot.objects[o];
    for (std::uint32_t k = 0; k < object.vertexCount; ++k) {
      const std::uint32_t index = object.firstVertex + k;
      const glm::vec3 local = state.positions.empty() ? scene.positions[index] : state.positions[k];
      const glm::vec3 world(state.toWorld * glm::vec4(local, 1.0f));
      mesh.positions[index] = (world - grid.low) / grid.voxelSize;
      mesh.normals[index] = state.normalToWorld * scene.normals[index];
    }
    for (const Part& part : object.parts)
      for (std::uint32_t i = 0; i < part.indexCount; i += 3) {
        const std::uint32_t* corner = &scene.indices[part.firstIndex + i];
        mesh.triangles.push_back({{corner[0], corner[1], corner[2]}, part.material});
      }
  }
  return mesh;
}

namespace {

constexpr float kRounding = 3e-7f;  // as in shaders/voxelization

/// The interval tests of one projection of a triangle: per edge an axis, and the interval along it in which
/// centres of touched voxels lie.
struct EdgeTests {
  float axisX[3], axisY[3], low[3], high[3];

  void set(const float (&x)[3], const float (&y)[3], float half) {
    for (int i = 0; i < 3; ++i) {
      const int j = i == 2 ? 0 : i + 1, k = i == 0 ? 2 : i - 1;
      axisX[i] = y[i] - y[j];
      axisY[i] = x[j] - x[i];
      const float onEdge = axisX[i] * x[i] + axisY[i] * y[i], opposite = axisX[i] * x[k] + axisY[i] * y[k];
      const float reach = half * (std::abs(axisX[i]) + std::abs(axisY[i]));
      low[i] = std::min(onEdge, opposite) - reach;
      high[i] = std::max(onEdge, opposite) + reach;
    }
  }
  bool within(float x, float y) const {
    bool inside = true;
    for (int i = 0; i < 3; ++i) {
      const float value = axisX[i] * x + axisY[i] * y;
      inside &= value >= low[i] && value <= high[i];
    }
    return inside;
  }
};

/// Calls `found(x, y, z)` for every voxel of the grid that the triangle touches.
template <class Found>
void forEachTouched(const glm::vec3& cornerA, const glm::vec3& cornerB, const glm::vec3& cornerC,
                    const glm::ivec3& resolution, const Found& found) {
  const glm::vec3 least = glm::min(cornerA, glm::min(cornerB, cornerC)),
                  most = glm::max(cornerA, glm::max(cornerB, cornerC));
  const glm::vec3 extent = most - least;
  const float tolerance =
      kRounding * (static_cast<float>(std::max({resolution.x, resolution.y, resolution.z})) +
                   std::max({extent.x, extent.y, extent.z}));
  const glm::vec3 limit(resolution);
  const glm::ivec3 low(glm::clamp(glm::floor(least - tolerance), glm::vec3(0.0f), limit)),
      high(glm::clamp(glm::floor(most + tolerance), glm::vec3(-1.0f), limit - 1.0f));
  const glm::ivec3 size = high - low;
  if (size.x < 0 || size.y < 0 || size.z < 0) return;
  // The bounds are one voxel wide in two directions, so the triangle touches every voxel of the row.
  if ((size.x == 0) + (size.y == 0) + (size.z == 0) >= 2) {
    for (int z = low.z; z <= high.z; ++z)
      for (int y = low.y; y <= high.y; ++y)
        for (int x = low.x; x <= high.x; ++x) found(x, y, z);
    return;
  }
  const glm::vec3 origin = glm::floor(least), a = cornerA - origin, b = cornerB - origin,
                  c = cornerC - origin;
  const glm::vec3 normal = glm::cross(b - a, c - a), magnitude = glm::abs(normal);
  const int w = magnitude.x > magnitude.y && magnitude.x > magnitude.z ? 0
                : magnitude.y > magnitude.z                            ? 1
                                                                       : 2;
  const int u = (w + 1) % 3, v = (w + 2) % 3;
  const float half = 0.5f + tolerance;
  const float rounding =
      kRounding * glm::length(b - a) * glm::length(c - a) * (extent.x + extent.y + extent.z + 1.0f);
  const float reach = half * (magnitude.x + magnitude.y + magnitude.z) + rounding;
  const float planeLow = glm::dot(normal, a) - reach, planeHigh = glm::dot(normal, a) + reach;
  EdgeTests uv, vw, wu;
  const float us[3] = {a[u], b[u], c[u]}, vs[3] = {a[v], b[v], c[v]}, ws[3] = {a[w], b[w], c[w]};
  uv.set(us, vs, half);
  vw.set(vs, ws, half);
  wu.set(ws, us, half);
  const float inverse = magnitude[w] > 0.0f ? 1.0f / normal[w] : 0.0f;
  const bool needle = !(magnitude[w] > 1e-6f * (extent.x + extent.y + extent.z));
  glm::ivec3 voxel;
  for (voxel[v] = low[v]; voxel[v] <= high[v]; ++voxel[v]) {
    const float cv = static_cast<float>(voxel[v]) + 0.5f - origin[v];
    for (voxel[u] = low[u]; voxel[u] <= high[u]; ++voxel[u]) {
      const float cu = static_cast<float>(voxel[u]) + 0.5f - origin[u];
      if (!uv.within(cu, cv)) continue;
      int first = low[w], last = high[w];
      if (!needle) {
        // Depths at which a centre lies within the plane's interval.
        const float rest = normal[u] * cu + normal[v] * cv;
        const float one = (planeLow - rest) * inverse, other = (planeHigh - rest) * inverse;
        first = std::max(first, static_cast<int>(std::floor(origin[w] + std::min(one, other) - 0.51f)));
        last = std::min(last, static_cast<int>(std::floor(origin[w] + std::max(one, other) - 0.49f)));
      }
      for (voxel[w] = first; voxel[w] <= last; ++voxel[w]) {
        const float cw = static_cast<float>(voxel[w]) + 0.5f - origin[w];
        const float height = normal[u] * cu + normal[v] * cv + normal[w] * cw;
        if (height < planeLow || height > planeHigh || !vw.within(cv, cw) || !wu.within(cw, cu)) continue;
        found(voxel.x, voxel.y, voxel.z);
      }
    }
  }
}

/// Octahedral encoding; the normal need not have unit length.
std::uint32_t packNormal(const glm::vec3& normal) {
  const float inverse = 1.0f / (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
  float x = normal.x * inverse, y = normal.y * inverse;
  if (normal.z < 0.0f) {
    const float folded = std::copysign(1.0f - std::abs(y), x);
    y = std::copysign(1.0f - std::abs(x), y);
    x = folded;
  }
  const auto step = [](float value) {
    return static_cast<std::uint32_t>(
               static_cast<std::int32_t>(value * 32767.0f + std::copysign(0.5f, value))) &
           0xFFFFu;
  };
  return step(x) | step(y) << 16;
}

std::uint32_t packSteps(const glm::vec3& offset) {
  const glm::uvec3 steps(glm::clamp(offset, 0.0f, 1.0f) * 1023.0f + 0.5f);
  return steps.x | steps.y << 10 | steps.z << 20;
}

/// Bilinear at mip level 0, which is less work than the voxelizers' choice of a level.
glm::vec3 sampled(const SurfaceTexture& texture, const glm::vec2& at) {
  const float x = at.x * static_cast<float>(texture.width) - 0.5f,
              y = (1.0f - at.y) * static_cast<float>(texture.height) - 0.5f;
  const auto wrapped = [](int value, int size) { return ((value % size) + size) % size; };
  const auto x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  const float u = x - std::floor(x), v = y - std::floor(y);
  const auto texel = [&](int tx, int ty) {
    const std::size_t place =
        static_cast<std::size_t>(wrapped(ty, texture.height)) * static_cast<std::size_t>(texture.width) +
        static_cast<std::size_t>(wrapped(tx, texture.width));
    if (texture.mask) return glm::vec3(texture.values[place]);
    const float* value = &texture.values[3 * place];
    return glm::vec3(value[0], value[1], value[2]);
  };
  return glm::mix(glm::mix(texel(x0, y0), texel(x0 + 1, y0), u),
                  glm::mix(texel(x0, y0 + 1), texel(x0 + 1, y0 + 1), u), v);
}

constexpr int kMostThreads = 16;
constexpr std::size_t kGrain = 512;  // triangles that one task takes at a time

}  // namespace

struct CpuLoops::State {
  explicit State(const Mesh& input) : mesh(input), words(VoxelSet(input.grid.resolution).words().size()) {}

  const Mesh& mesh;
  std::vector<std::uint64_t> words;
  mutable VoxelSet occupied;
  std::vector<Fragment> list;
  std::atomic<std::uint64_t> count{0};
  /// Each thread's fragments, reused from call to call. Aligned to its own cache line, since every fragment
  /// writes its size.
  struct alignas(64) Scratch {
    std::vector<Fragment> fragments;
  };
  Scratch scratch[kMostThreads];

  template <bool kShared>
  void markBits(std::size_t first, std::size_t last) {
    const glm::ivec3 size = mesh.grid.resolution;
    for (std::size_t i = first; i < last; ++i) {
      const Mesh::Triangle& triangle = mesh.triangles[i];
      forEachTouched(mesh.positions[triangle.corner[0]], mesh.positions[triangle.corner[1]],
                     mesh.positions[triangle.corner[2]], size, [&](int x, int y, int z) {
                       const auto bit =
                           static_cast<std::uint64_t>(x) +
                           static_cast<std::uint64_t>(size.x) *
                               (static_cast<std::uint64_t>(y) +
                                static_cast<std::uint64_t>(size.y) * static_cast<std::uint64_t>(z));
                       const std::uint64_t mask = std::uint64_t{1} << (bit & 63);
                       if constexpr (kShared) {
                         std::atomic_ref<std::uint64_t> word(words[bit >> 6]);
                         if ((word.load(std::memory_order_relaxed) & mask) == 0)
                           word.fetch_or(mask, std::memory_order_relaxed);
                       } else {
                         words[bit >> 6] |= mask;
                       }
                     });
    }
  }

  void appendFragments(std::size_t first, std::size_t last, std::vector<Fragment>& mine) const {
    for (std::size_t i = first; i < last; ++i) {
      const Mesh::Triangle& triangle = mesh.triangles[i];
      const auto [ia, ib, ic] = triangle.corner;
      const glm::vec3 &a = mesh.positions[ia], &b = mesh.positions[ib], &c = mesh.positions[ic];
      const Material& material = mesh.scene->materials[static_cast<std::size_t>(triangle.material)];
      const auto textureAt = [&](int index) {
        return index < 0 ? nullptr : &mesh.scene->textures[static_cast<std::size_t>(index)];
      };
      const SurfaceTexture *diffuse = textureAt(material.diffuseTexture),
                           *mask = textureAt(material.maskTexture);
      Fragment fragment{};
      fragment.albedoRg = glm::packHalf2x16(glm::vec2(material.diffuse.x, material.diffuse.y));
      fragment.albedoBCoverage = glm::packHalf2x16(glm::vec2(material.diffuse.z, 1.0f));
      const glm::vec3 edge1 = b - a, edge2 = c - a;
      const float d11 = glm::dot(edge1, edge1), d12 = glm::dot(edge1, edge2), d22 = glm::dot(edge2, edge2);
      const float determinant = d11 * d22 - d12 * d12,
                  inverse = determinant > 0.0f ? 1.0f / determinant : 0.0f;
      forEachTouched(a, b, c, mesh.grid.resolution, [&](int x, int y, int z) {
        const glm::vec3 low(x, y, z), towards = low + 0.5f - a;
        // The nearest point of the triangle's plane, clamped to the triangle.
        const float p1 = glm::dot(towards, edge1), p2 = glm::dot(towards, edge2);
        float s = std::max((d22 * p1 - d12 * p2) * inverse, 0.0f),
              t = std::max((d11 * p2 - d12 * p1) * inverse, 0.0f);
        if (const float sum = s + t; sum > 1.0f) s /= sum, t /= sum;
        const float r = 1.0f - s - t;
        if (diffuse != nullptr || mask != nullptr) {
          const glm::vec2 at = r * mesh.texcoords[ia] + s * mesh.texcoords[ib] + t * mesh.texcoords[ic];
          const glm::vec3 albedo =
              diffuse != nullptr ? material.diffuse * sampled(*diffuse, at) : material.diffuse;
          const float coverage = mask != nullptr ? sampled(*mask, at).x : 1.0f;
          if (coverage <= 0.0f) return;
          fragment.albedoRg = glm::packHalf2x16(glm::vec2(albedo.x, albedo.y));
          fragment.albedoBCoverage = glm::packHalf2x16(glm::vec2(albedo.z, coverage));
        }
        fragment.voxel = static_cast<std::uint32_t>(x) | static_cast<std::uint32_t>(y) << 10 |
                         static_cast<std::uint32_t>(z) << 20;
        fragment.offset = packSteps(a + s * edge1 + t * edge2 - low);
        fragment.normal = packNormal(r * mesh.normals[ia] + s * mesh.normals[ib] + t * mesh.normals[ic]);
        mine.push_back(fragment);
      });
    }
  }

  /// The first call only counts; then the list is allocated with the right length.
  void flush(std::vector<Fragment>& mine) {
    const std::uint64_t first = count.fetch_add(mine.size());
    if (first + mine.size() <= list.size())
      std::memcpy(list.data() + first, mine.data(), mine.size() * sizeof(Fragment));
    mine.clear();
  }

  /// Calls `work(first, last, thread)` over all triangles. It starts its own threads: the workers of a
  /// scheduler may still be asleep when a job of a few milliseconds is over.
  template <class Work>
  void overTriangles(int threads, const Work& work) {
    std::atomic<std::size_t> next{0};
    assert(threads <= kMostThreads);
    const auto run = [&](int thread) {
      for (std::size_t first = next.fetch_add(kGrain); first < mesh.triangles.size();
           first = next.fetch_add(kGrain))
        work(first, std::min(first + kGrain, mesh.triangles.size()), thread);
    };
    std::vector<std::jthread> helpers;
    for (int i = 1; i < threads; ++i) helpers.emplace_back(run, i);
    run(0);
  }
};

CpuLoops::CpuLoops(const Mesh& mesh) : state_(std::make_unique<State>(mesh)) {
  fragments(1);
  state_->list.resize(state_->count);
}
CpuLoops::~CpuLoops() = default;

void CpuLoops::bits(int threads) {
  State& s = *state_;
  std::fill(s.words.begin(), s.words.end(), 0);
  s.overTriangles(threads, [&](std::size_t first, std::size_t last, int) {
    threads == 1 ? s.markBits<false>(first, last) : s.markBits<true>(first, last);
  });
}

const VoxelSet& CpuLoops::occupied() const {
  const glm::ivec3 size = state_->mesh.grid.resolution;
  state_->occupied = VoxelSet(size);
  std::uint64_t bit = 0;
  for (int z = 0; z < size.z; ++z)
    for (int y = 0; y < size.y; ++y)
      for (int x = 0; x < size.x; ++x, ++bit)
        if (state_->words[bit >> 6] >> (bit & 63) & 1) state_->occupied.insert({x, y, z});
  return state_->occupied;
}

std::uint64_t CpuLoops::fragments(int threads) {
  State& s = *state_;
  s.count = 0;
  s.overTriangles(threads, [&](std::size_t first, std::size_t last, int thread) {
    std::vector<Fragment>& mine = s.scratch[thread].fragments;
    s.appendFragments(first, last, mine);
    s.flush(mine);
  });
  return s.count;
}

std::span<const Fragment> CpuLoops::list() const {
  return state_->list;
}

}  // namespace lumivox::bench
