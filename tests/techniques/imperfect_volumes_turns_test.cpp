// Light of the frame before in turns: which voxels renew it, which keep it, and what counts as held.
#include <algorithm>
#include <limits>
#include <set>

#include "support/imperfect_volumes.h"

using namespace lumivox;
using namespace lumivox::test;
using namespace lumivox::test::volumes;

namespace {

const std::vector<ReadPoint> kSeen{{{1.0f, 5.2f, 7.7f}, {1, 0, 0}}, {{7.3f, 1.0f, 9.8f}, {0, 1, 0}}};

/// `march` over frames in a row, each with the light of the one before.
class Frames {
 public:
  explicit Frames(int turns) : march_(volumePass("march", underSky(0.0), static_cast<int>(kSeen.size()))) {
    march_.with({{"rays", 30}, {"turns", turns}}).in("gbuffer", seen(kSeen));
    march_.harness().accumulate();
  }
  ShGrid next(const Volume& volume) {
    march_.in("opacity", volume.opacity())
        .in("reflected", volume.reflected())
        .in("attributes", volume.attributes());
    const ShGrid result = march_.out<ShGrid>("carried");
    march_.in("before", result);
    return result;
  }
  /// Replaces the light that the next frame finds.
  Frames& before(const ShGrid& light) {
    march_.in("before", light);
    return *this;
  }

 private:
  LonePass march_;
};

std::vector<float> coefficientsOf(const ShGrid& light) {
  return light.levels[0].coefficients[0]->downloadFloats(0);
}
/// The constant band of the first channel, which is positive where light of a closed room arrives.
std::vector<float> meansIn(const ShGrid& light) {
  const std::vector<float> values = coefficientsOf(light);
  std::vector<float> means;
  for (std::size_t i = 0; i < values.size(); i += 4) means.push_back(values[i]);
  return means;
}

/// Light of the voxels that pixels read, and no others.
std::vector<float> seenIn(const Volume& volume) {
  LonePass march = marching(volume, {{"rays", 30}});
  march.in("gbuffer", seen(kSeen)).keepOnly("incoming");
  return meansIn(march.out<ShGrid>("incoming"));
}

}  // namespace

TEST_CASE(
    "a voxel that no pixel reads renews its light once in eight frames, and the voxels of a block one after another") {
  const int turns = 8;
  // Black walls: what arrives is direct light, and doubles when the walls send twice as much.
  const Volume once = closedRoom(10, 1.0, 0.0), twice = closedRoom(10, 2.0, 0.0);
  const std::vector<float> pixels = seenIn(once);
  Frames frames(turns);
  const std::vector<float> first = meansIn(frames.next(once));
  for (int frame = 1; frame < turns; ++frame) {
    const Volume& volume = frame % 2 == 0 ? twice : once;
    INFO("all rays begin in the first frames");
    CHECK(meansIn(frames.next(volume)) == meansIn(Frames(turns).next(volume)));
  }
  std::vector<std::vector<float>> later;
  for (int frame = 0; frame < turns; ++frame) later.push_back(meansIn(frames.next(twice)));
  for (int frame = 0; frame < turns; ++frame) later.push_back(meansIn(frames.next(once)));

  std::vector<int> renewedIn(first.size(), 0);
  std::vector<int> count(turns, 0);
  int hidden = 0, wrong = 0;
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (first[i] == 0.0f) {
      for (const std::vector<float>& frame : later) CHECK(frame[i] == 0.0f);
      continue;
    }
    const auto isRenewed = [&](int frame) {
      return later[static_cast<std::size_t>(frame)][i] == 2.0f * first[i];
    };
    int at = 0;
    while (at < turns - 1 && !isRenewed(at)) ++at;
    renewedIn[i] = at;
    if (pixels[i] != 0.0f) {
      CHECK(at == 0);
      continue;
    }
    ++hidden;
    ++count[static_cast<std::size_t>(at)];
    // Kept until the same turn of the next eight frames.
    for (int frame = 0; frame < 2 * turns; ++frame) {
      const bool holdsTwice = frame >= at && frame < at + turns;
      wrong += isRenewed(frame) != holdsTwice ? 1 : 0;
    }
  }
  REQUIRE(hidden > 400);
  CHECK(wrong == 0);
  for (const int part : count) CHECK(part == Approx(hidden / 8.0).epsilon(0.2));
  int pairs = 0, together = 0;
  once.forEach([&](const glm::ivec3& low) {
    std::set<int> found;
    int read = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::ivec3 voxel = low + glm::ivec3(corner & 1, corner >> 1 & 1, corner >> 2);
      if (glm::any(glm::greaterThanEqual(voxel, once.size()))) continue;
      const std::size_t i = once.at(voxel);
      if (first[i] == 0.0f || pixels[i] != 0.0f) continue;
      ++read;
      found.insert(renewedIn[i]);
    }
    pairs += read > 1 ? 1 : 0;
    together += read - static_cast<int>(found.size());
  });
  CHECK(pairs > 200);
  CHECK(together == 0);
}

namespace {

/// The room with one wall a voxel farther in: its surfaces read voxels that nothing read before, and others
/// that were read.
Volume narrowed(double radiance, double albedo) {
  Volume room = closedRoom(10, radiance, albedo);
  return room.occupyWhere(
      [&](const glm::ivec3& voxel) {
        return voxel.z == 1 && glm::all(glm::greaterThan(glm::ivec2(voxel), glm::ivec2(0))) &&
               glm::all(glm::lessThan(glm::ivec2(voxel), glm::ivec2(11)));
      },
      [](const glm::ivec3&) { return glm::dvec3(0, 0, 1); }, radiance, 0.0, albedo);
}

}  // namespace

TEST_CASE("a voxel that held nothing renews its light at once when surfaces come to read it") {
  const Volume wide = closedRoom(10, 1.0, 0.0), narrow = narrowed(2.0, 0.0);
  Frames frames(8);
  for (int frame = 1; frame < 8; ++frame) frames.next(wide);
  const std::vector<float> before = meansIn(frames.next(wide)), after = meansIn(frames.next(narrow)),
                           anew = meansIn(Frames(8).next(narrow));
  int fresh = 0, kept = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    CHECK((after[i] != 0.0f) == (anew[i] != 0.0f));
    if (before[i] == 0.0f && anew[i] != 0.0f) {
      ++fresh;
      CHECK(after[i] == anew[i]);
    } else if (after[i] != 0.0f && after[i] == before[i] && after[i] != anew[i]) {
      ++kept;
    }
  }
  CHECK(fresh > 50);
  CHECK(kept > 50);
}

TEST_CASE("light of the frame before counts only where voxels held some, whatever stands in the others") {
  const Volume wide = closedRoom(10, 1.0, 0.8), narrow = narrowed(1.0, 0.8);
  Frames frames(8), misled(8);
  const ShGrid light = frames.next(wide);
  ShGrid wrong = misled.next(wide);
  const std::vector<float> means = meansIn(light);
  for (gpu::TextureRef& channel : wrong.levels[0].coefficients) {
    std::vector<float> values = channel->downloadFloats(0);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (means[i / 4] == 0.0f) values[i] = 1e9f;
    channel = volumeTexture(wide.size(), gpu::Format::rgba32f, values);
  }
  misled.before(wrong);
  CHECK(coefficientsOf(misled.next(narrow)) == coefficientsOf(frames.next(narrow)));
}

TEST_CASE("even light is reflected evenly, in front of walls, edges and corners alike") {
  const Volume room = closedRoom(10, 0.0, 0.5);
  Frames frames(8);
  frames.next(room);
  const ShGrid even = evenLight(room, [](const glm::ivec3&, int) { return 1.0; });
  const std::vector<float> means = meansIn(frames.before(even).next(room)),
                           pixels = seenIn(closedRoom(10, 1.0));
  int seenFree = 0;
  room.forEach([&](const glm::ivec3& voxel) {
    if (pixels[room.at(voxel)] == 0.0f || room.set().contains(voxel)) return;
    ++seenFree;
    CHECK(means[room.at(voxel)] == Approx(double{constant(0.5).x}).epsilon(1e-3));
  });
  CHECK(seenFree > 20);
}

TEST_CASE("each side of a wall reflects the light in front of it, and none of that behind it") {
  // Two rooms, and light of the frame before in the upper one alone.
  Volume rooms = closedRoom(11, 0.0, 0.5);
  const int wall = 6;
  rooms.occupyWhere([&](const glm::ivec3& voxel) { return voxel.z == wall && !rooms.set().contains(voxel); },
                    [](const glm::ivec3&) { return glm::dvec3(0, 0, 1); }, 0.0, 0.0, 0.5);
  const ShGrid upper =
      evenLight(rooms, [&](const glm::ivec3& voxel, int) { return voxel.z > wall ? 1.0 : 0.0; });
  Frames frames(8);
  frames.next(rooms);
  const std::vector<float> means = meansIn(frames.before(upper).next(rooms));
  double below = 0.0;
  int above = 0, dark = 0;
  rooms.forEach([&](const glm::ivec3& voxel) {
    const double mean = means[rooms.at(voxel)] / constant(0.5).x;
    if (rooms.set().contains(voxel) || mean == 0.0) return;
    if (voxel.z > wall) {
      ++above;
      CHECK(mean == Approx(1.0).epsilon(1e-3));
    } else {
      below += mean;
      ++dark;
    }
  });
  REQUIRE(above > 50);
  REQUIRE(dark > 50);
  CAPTURE(below / dark);
  // A wall that shone to both rooms would fill a fifth of what the lower one sees. Where it meets the others
  // both sides of a voxel have one mean normal, and that voxel does.
  CHECK(below / dark < 0.1);
}
