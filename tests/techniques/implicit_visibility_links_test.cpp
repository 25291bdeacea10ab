// Which surface elements see which.
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "support/closed_room.h"
#include "support/surface_elements.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

struct RowSums {
  double mean = 0.0, least = 1e9, most = 0.0, filled = 0.0;
};
/// Of the projected solid angles of the bins on the front of each leaf, over pi, and the share of these bins
/// that hold a link.
RowSums rowSums(const LinkedScene& scene) {
  const BinWeights weights(scene.links);
  RowSums sums;
  double bins = 0.0, filled = 0.0;
  for (std::uint32_t leaf = 0; leaf < scene.tree().leafCount; ++leaf) {
    const glm::vec3 normal = scene.state().normal[leaf];
    double sum = 0.0;
    for (const ElementLink& link : scene.seenBy(leaf)) {
      const double weight = weights(normal, link.bin());
      if (weight > 0.0) sum += weight, filled += 1.0;
    }
    for (std::uint32_t bin = 0; bin < weights.count(); ++bin) bins += weights(normal, bin) > 0.0;
    sum *= weights.scale(normal) / kPi;
    sums.mean += sum / scene.tree().leafCount;
    sums.least = std::min(sums.least, sum);
    sums.most = std::max(sums.most, sum);
  }
  sums.filled = filled / bins;
  return sums;
}

std::vector<std::uint32_t> ancestorsOf(const ElementTree& tree, std::uint32_t node) {
  std::vector<std::uint32_t> result;
  for (node = tree.parents[node]; node != kNoElement; node = tree.parents[node]) result.push_back(node);
  return result;
}

/// A small sheet of 4 x 4 elements, a small one above it and another one above that, straight above each
/// other.
Scene threeSheets() {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  builder.quad({-0.2f, 0, -0.2f}, {0, 0, 0.4f}, {0.4f, 0, 0}, grey);
  builder.quad({-0.4f, 8, -0.4f}, {0.8f, 0, 0}, {0, 0, 0.8f}, grey);
  builder.quad({-0.2f, 0.4f, -0.2f}, {0.4f, 0, 0}, {0, 0, 0.4f}, grey);
  return builder.scene;
}

/// Irradiance of leaves in light that varies over the scene, from their front.
std::vector<double> gathered(const LinkedScene& scene) {
  const BinWeights weights(scene.links);
  std::vector<double> result;
  for (std::uint32_t leaf = 0; leaf < scene.tree().leafCount; ++leaf) {
    const glm::vec3 normal = scene.state().normal[leaf];
    double sum = 0.0;
    for (const ElementLink& link : scene.seenBy(leaf)) {
      const glm::vec3 at = scene.state().position[link.node];
      const double radiance = 1.0 + std::sin(5.0 * at.x) * std::cos(4.0 * at.y + 3.0 * at.z);
      sum += std::max(weights(normal, link.bin()), 0.0) * radiance;
    }
    result.push_back(sum * weights.scale(normal));
  }
  return result;
}

}  // namespace

TEST_CASE("in a closed room every bin sees a wall: irradiance is pi times the radiance of the walls") {
  for (const double count : {400.0, 1000.0, 4096.0})
    for (const double bins : {8.0, 12.0}) {
      const RowSums sums = rowSums(linked(closedCube(), {{{"elements", count}}, {{"bins", bins}}, {}}));
      CAPTURE(count, bins, sums.mean, sums.least);
      CHECK(sums.filled >= 0.995);
      CHECK(sums.mean == Approx(1.0).margin(0.005));
      CHECK(sums.least > 0.995);
      CHECK(sums.most < 1.00001);
    }
  const RowSums furnished = rowSums(linked(furnishedCube(), {{{"elements", 2000}}, {}, {}}));
  CAPTURE(furnished.least);
  CHECK(furnished.filled >= 0.995);
  CHECK(furnished.mean == Approx(1.0).margin(0.005));
}

TEST_CASE("links of the hierarchy fill the bins that all pairs fill, at the same distances") {
  const Settings elements{{"elements", 600}};
  const LinkedScene tree = linked(furnishedCube(), {elements, {}, {}}),
                    all = linked(furnishedCube(), {elements, {{"method", "all_pairs"}}, {}});
  std::size_t different = 0, links = 0;
  for (std::uint32_t leaf = 0; leaf < tree.tree().leafCount; ++leaf) {
    std::map<std::uint32_t, float> distances;
    for (const ElementLink& link : all.seenBy(leaf)) distances[link.bin()] = link.distance();
    for (const ElementLink& link : tree.seenBy(leaf))
      different += !distances.contains(link.bin()) ||
                   std::abs(distances[link.bin()] - link.distance()) > 0.01f * link.distance();
    links += distances.size();
    different += distances.size() > tree.seenBy(leaf).size();
  }
  CAPTURE(links, different);
  CHECK(different < links / 1000);
}

TEST_CASE("as published, pushed as made and in one bin each, a closed room has holes") {
  const LinkSettings one{{{"elements", 1000}}, {{"bins", 12}}, {{"fill", "one"}}};
  CHECK(rowSums(linked(closedCube(), one)).mean < 0.8);
  const LinkSettings kept{{{"elements", 1000}}, {{"split", 1}}, {{"push", "kept"}}};
  const RowSums sums = rowSums(linked(closedCube(), kept));
  CAPTURE(sums.mean, sums.least);
  CHECK(sums.mean > 0.97);
  CHECK(sums.mean < 0.99);
  CHECK(sums.most < 1.00001);
}

TEST_CASE("split down to the leaves, links are those of all pairs, bit for bit") {
  for (const std::string fill : {"centre", "one"}) {
    const Settings elements{{"elements", 300}}, push{{"fill", fill}};
    const LinkedScene split = linked(furnishedCube(), {elements, {{"split", 0}}, push}),
                      all = linked(furnishedCube(), {elements, {{"method", "all_pairs"}}, push});
    const std::uint64_t leaves = split.tree().leafCount;
    CHECK(split.pairs.stillPartners->values.size() == leaves * (leaves - 1));
    CHECK(*split.links.seen == *all.links.seen);
    CHECK(!all.links.seen->values.empty());
  }
}

TEST_CASE("every two leaves are joined by exactly one pair of them or of their ancestors") {
  const LinkedScene scene = linked(furnishedCube(), {{{"elements", 250}}, {}, {}});
  const ElementTree& tree = scene.tree();
  std::vector<std::vector<std::uint32_t>> leaves(tree.nodeCount);
  for (std::uint32_t leaf = 0; leaf < tree.leafCount; ++leaf) {
    leaves[leaf].push_back(leaf);
    for (const std::uint32_t node : ancestorsOf(tree, leaf)) leaves[node].push_back(leaf);
  }
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> joined;
  for (std::uint32_t node = 0; node < tree.nodeCount; ++node)
    for (const std::uint32_t partner : (*scene.pairs.stillPartners)[node])
      for (const std::uint32_t a : leaves[node])
        for (const std::uint32_t b : leaves[partner]) ++joined[{a, b}];
  CHECK(joined.size() == std::size_t{tree.leafCount} * (tree.leafCount - 1));
  CHECK(std::all_of(joined.begin(), joined.end(), [](const auto& pair) { return pair.second == 1; }));
}

TEST_CASE("what a leaf sees is the nearest over itself and all nodes above it") {
  for (const std::string push : {"kept", "rebinned"}) {
    const LinkedScene scene =
        linked(furnishedCube(), {{{"elements", 400}}, {}, {{"fill", "one"}, {"push", push}}});
    const ElementTree& tree = scene.tree();
    const ElementState& state = scene.state();
    const DirectionBins bins(scene.links.bins, scene.links.mapping);
    std::size_t differences = 0;
    for (std::uint32_t leaf = 0; leaf < tree.leafCount; ++leaf) {
      std::map<std::uint32_t, std::pair<float, std::uint32_t>> nearest;
      std::vector<std::uint32_t> eyes = ancestorsOf(tree, leaf);
      eyes.push_back(leaf);
      for (const std::uint32_t eye : eyes)
        for (const std::uint32_t partner : (*scene.pairs.stillPartners)[eye]) {
          const std::uint32_t from = push == "kept" ? eye : leaf;
          const glm::vec3 away = state.position[partner] - state.position[from];
          const std::uint32_t bin = bins.binOf(away);
          if (from == leaf) {  // only what reaches above its plane on the side of the bin
            const glm::vec3 normal = state.normal[leaf];
            const float height = glm::dot(normal, away), flat = 1e-4f * glm::length(away),
                        above = state.reach[partner] *
                                glm::length(glm::cross(normal, glm::normalize(state.normal[partner])));
            if (glm::dot(normal, bins.centre(bin)) > 0.0f ? height + above <= flat : height - above >= -flat)
              continue;
          }
          const std::pair key(glm::length(away), partner);
          const auto [at, isNew] = nearest.try_emplace(bin, key);
          at->second = std::min(at->second, key);
        }
      const std::span<const ElementLink> seen = scene.seenBy(leaf);
      if (seen.size() != nearest.size()) ++differences;
      for (const ElementLink& link : seen)
        differences += !nearest.contains(link.bin()) || nearest[link.bin()].second != link.node;
    }
    CAPTURE(push);
    CHECK(differences == 0);
  }
}

TEST_CASE("one, two and seven threads make the same bits") {
  const auto with = [](std::size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return linked(furnishedCube(true), {{{"elements", 600}}, {}, {}}, 1.0);
  };
  const LinkedScene one = with(1), two = with(2), seven = with(7);
  REQUIRE(!one.links.seen->values.empty());
  for (const LinkedScene* other : {&two, &seven}) {
    CHECK(*one.pairs.stillPartners == *other->pairs.stillPartners);
    CHECK(*one.pairs.movingPartners == *other->pairs.movingPartners);
    CHECK(*one.links.seen == *other->links.seen);
    CHECK(one.state().position == other->state().position);
  }
}

TEST_CASE("a nearer element linked further down hides the one behind it (Fig. 4)") {
  for (const std::string push : {"kept", "rebinned"}) {
    const LinkedScene scene = linked(threeSheets(), {{{"elements", 48}, {"share", 0}},
                                                     {{"bins", 4}, {"split", 0.25}},
                                                     {{"push", push}, {"fill", "one"}}});
    const ElementTree& tree = scene.tree();
    const auto objectOf = [&](std::uint32_t node) { return tree.objectOfNode[node]; };
    // The far sheet is linked with inner nodes of the lower one, the near sheet with its leaves.
    bool farAbove = false, nearBelow = false;
    for (std::uint32_t node = 0; node < tree.nodeCount; ++node)
      for (const std::uint32_t partner : (*scene.pairs.stillPartners)[node]) {
        if (objectOf(node) != 0) continue;
        farAbove = farAbove || (!tree.isLeaf(node) && objectOf(partner) == 1);
        nearBelow = nearBelow || (tree.isLeaf(node) && objectOf(partner) == 2);
      }
    CHECK(farAbove);
    CHECK(nearBelow);
    const DirectionBins bins(4, BinMapping::even);
    for (std::uint32_t leaf = 0; leaf < tree.leafCount; ++leaf) {
      if (objectOf(leaf) != 0) continue;
      std::set<std::uint32_t> nearBins;
      for (std::uint32_t other = 0; other < tree.leafCount; ++other)
        if (objectOf(other) == 2)
          nearBins.insert(bins.binOf(scene.state().position[other] - scene.state().position[leaf]));
      bool seesNear = false;
      for (const ElementLink& link : scene.seenBy(leaf)) {
        if (objectOf(link.node) == 1) CHECK(!nearBins.contains(link.bin()));
        seesNear = seesNear || objectOf(link.node) == 2;
      }
      CHECK(seesNear);
    }
  }
}

TEST_CASE("light over links of the hierarchy and over those of all pairs differs by at most a twentieth") {
  const Settings elements{{"elements", 1500}};
  const std::vector<double> byTree = gathered(linked(furnishedCube(), {elements, {}, {}})),
                            all =
                                gathered(linked(furnishedCube(), {elements, {{"method", "all_pairs"}}, {}}));
  double square = 0.0, mean = 0.0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    square += (byTree[i] - all[i]) * (byTree[i] - all[i]) / static_cast<double>(all.size());
    mean += all[i] / static_cast<double>(all.size());
  }
  CAPTURE(std::sqrt(square) / mean);
  CHECK(std::sqrt(square) <= 0.05 * mean);
  CHECK(square > 0.0);
}

TEST_CASE("links among things that stand still are apart from those with an end that moves") {
  const LinkedScene scene = linked(furnishedCube(true), {{{"elements", 500}}, {}, {}}, 2.0);
  const ElementTree& tree = scene.tree();
  std::size_t still = 0, moving = 0;
  for (std::uint32_t node = 0; node < tree.nodeCount; ++node) {
    for (const std::uint32_t partner : (*scene.pairs.stillPartners)[node]) {
      CHECK((scene.state().still[node] && scene.state().still[partner]));
      ++still;
    }
    for (const std::uint32_t partner : (*scene.pairs.movingPartners)[node]) {
      CHECK(!(scene.state().still[node] && scene.state().still[partner]));
      ++moving;
    }
  }
  CHECK(still > moving);
  CHECK(moving > 0);
}

TEST_CASE("planes of one degree between them, needles and coplanar doubles have bounded links") {
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  const float lift = std::tan(1.0f * 3.14159265f / 180.0f);
  builder.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, grey);
  builder.quad({0, 0, 0}, {1, lift, 0}, {0, 0, 1}, grey);
  builder.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, grey);
  builder.mesh({{0, 1, 0}, {1, 1, 0}, {1, 1.000001f, 0}}, grey);
  builder.mesh({{0, 2, 0}, {1, 2, 0}, {2, 2, 0}}, grey);
  const RowSums sums = rowSums(linked(builder.scene, {{{"elements", 600}}, {}, {}}));
  CHECK(sums.most < 1.00001);
  CHECK(sums.mean > 0.1);
}

TEST_CASE("of two sheets on each other, hardly apart in their plane, none hides the other's sky") {
  // Turned, so that places are rounded to above and below the plane.
  SceneBuilder builder;
  const int grey = builder.lambert(0.5f);
  const glm::dmat4 turn = glm::mat4_cast(glm::angleAxis(1.1, glm::normalize(glm::dvec3(1, 2, -0.7))));
  for (const float shift : {0.0f, 3e-4f})
    builder.quad({shift, 0, shift}, {0, 0, 1}, {1, 0, 0}, grey).placement = turn;
  const RowSums sums = rowSums(linked(builder.scene, {{{"elements", 2048}, {"share", 0}}, {}, {}}));
  CHECK(sums.most == 0.0);
}

TEST_CASE("many thousand small squares need at most 4 times the pairs that one mesh of them needs") {
  const auto pairsOf = [](bool separate) {
    constexpr int kSide = 128;
    SceneBuilder builder;
    const int grey = builder.lambert(0.5f);
    std::vector<glm::vec3> corners;
    for (int j = 0; j < kSide; ++j)
      for (int i = 0; i < kSide; ++i) {
        const glm::vec3 corner(static_cast<float>(i), 0.1f * static_cast<float>((7 * i + 5 * j) % 11),
                               static_cast<float>(j));
        if (separate) builder.quad(corner, {0, 0, 0.7f}, {0.7f, 0, 0}, grey);
        const glm::vec3 right(0.7f, 0, 0), back(0, 0, 0.7f);
        corners.insert(corners.end(), {corner, corner + back, corner + right + back, corner,
                                       corner + right + back, corner + right});
      }
    if (!separate) builder.mesh(corners, grey);
    const SurfaceElements elements =
        LonePass("implicit_visibility.elements", builder.scene, {{"elements", 1024}})
            .out<SurfaceElements>("elements");
    REQUIRE(elements.leafCount == kSide * kSide);
    return LonePass("implicit_visibility.create_links", builder.scene)
        .in("elements", elements)
        .out<ElementLinks>("links")
        .stillPartners->values.size();
  };
  const std::size_t apart = pairsOf(true), mesh = pairsOf(false);
  CAPTURE(apart, mesh);
  CHECK(apart <= 4 * mesh);
  // All with all would be 16,384 * 16,383 ends.
  CHECK(apart < std::size_t{16384} * 16383 / 20);
}

TEST_CASE("the buffers on the device hold what each leaf sees, and its links to what shines") {
  Scene scene = furnishedCube();
  scene.materials.push_back(scene.materials.front());
  scene.materials.back().emission = glm::vec3(1.0f);
  scene.objects[3].parts.front().material = 1;
  const LinkedScene made = linked(scene, {{{"elements", 300}}, {}, {}});
  const auto first = made.links.first->downloadValues<glm::uvec4>();
  const auto links = made.links.links->downloadValues<ElementLink>();
  REQUIRE(made.links.lights != nullptr);
  const auto lights = made.links.lights->downloadValues<std::uint32_t>();
  const BinWeights weights(made.links);
  std::size_t shining = 0;
  for (std::uint32_t leaf = 0; leaf < made.tree().leafCount; ++leaf) {
    const std::span<const ElementLink> seen = made.seenBy(leaf);
    REQUIRE(first[leaf].y == seen.size());
    CHECK(static_cast<double>(std::bit_cast<float>(first[leaf].z)) ==
          weights.scale(made.state().normal[leaf]));
    std::vector<std::uint32_t> expected;
    for (std::uint32_t i = 0; i < seen.size(); ++i) {
      CHECK(links[first[leaf].x + i] == seen[i]);
      if (i > 0) CHECK(seen[i].bin() > seen[i - 1].bin());
      if (made.tree().emits[seen[i].node]) expected.push_back(first[leaf].x + i);
    }
    const std::uint32_t begin = lights[2 * leaf], count = lights[2 * leaf + 1];
    CHECK(std::vector(lights.begin() + begin, lights.begin() + begin + count) == expected);
    shining += count;
  }
  CHECK(shining > 0);
}

TEST_CASE("links grow as N log N with the number of elements, all pairs as its square", "[.]") {
  std::vector<double> leaves, rasterised, bytes;
  for (const double count : {4096.0, 16384.0, 65536.0}) {
    const LinkedScene scene = linked(closedCube(), {{{"elements", count}}, {}, {}});
    const ElementLists<std::uint32_t>& partners = *scene.pairs.stillPartners;
    std::size_t ends = 0;
    for (std::uint32_t leaf = 0; leaf < scene.tree().leafCount; ++leaf) {
      ends += partners[leaf].size();
      for (const std::uint32_t node : ancestorsOf(scene.tree(), leaf)) ends += partners[node].size();
    }
    leaves.push_back(scene.tree().leafCount);
    rasterised.push_back(static_cast<double>(ends));
    bytes.push_back(
        static_cast<double>(partners.values.size() * sizeof(std::uint32_t) + scene.links.links->sizeBytes()));
  }
  const auto exponent = [&](const std::vector<double>& values) {
    return std::log(values.back() / values.front()) / std::log(leaves.back() / leaves.front());
  };
  CAPTURE(leaves, rasterised, bytes, exponent(rasterised), exponent(bytes));
  CHECK(exponent(rasterised) <= 1.2);
  CHECK(exponent(bytes) <= 1.2);
  CHECK(exponent(rasterised) > 0.9);
}
