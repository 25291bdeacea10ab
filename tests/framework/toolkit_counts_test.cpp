// What the toolkit's own shaders count: dispatches over lists, sums of numbers before others, slots of
// voxels.
#include <map>
#include <random>

#include "lumivox/toolkit/counts.h"
#include "lumivox/toolkit/voxel_slots.h"
#include "pipeline_toys.h"
#include "support/voxel_fragments.h"

using namespace lumivox;
using namespace lumivox::test;

namespace {

/// Slots for the voxels of a list.
class Slots : public Toy {
 public:
  using Toy::Toy;
  In<VoxelFragments> fragments{this, "fragments", "surface samples"};
  VoxelSlots slots;
  std::uint64_t room = 0;
  int runs = 0;
  void run(PassContext& frame) override {
    ++runs;
    slots = claimSlots(frame, *fragments, room);
  }
};

struct Toolkit : Fixture {
  std::optional<PassHarness> harness;
  Toolkit() {
    techniques.add<Slots>("toy", "slots");
    harness.emplace(*device, techniques, "toy", "slots", scene, snapshotOf(scene, 0.0));
  }
  PassContext& frame() { return harness->context(); }
  Slots& pass() { return static_cast<Slots&>(harness->pass()); }
};

std::vector<std::uint32_t> wordsOf(const gpu::BufferRef& buffer, std::size_t count) {
  std::vector<std::uint32_t> words = buffer->downloadValues<std::uint32_t>();
  REQUIRE(words.size() >= count);
  words.resize(count);
  return words;
}

}  // namespace

TEST_CASE("a finished count has the groups of a dispatch over what there is room for, and what was wanted") {
  Toolkit f;
  struct Case {
    std::uint32_t items, capacity;
    int itemsOfGroup;
    std::uint32_t kept, x, y;
  };
  // Rows of 65535 groups, the last one too long; one group where there is nothing.
  for (const Case& one :
       {Case{0, 10, 64, 0, 1, 1}, Case{1, 10, 64, 1, 1, 1}, Case{64, 100, 64, 64, 1, 1},
        Case{65, 100, 64, 65, 2, 1}, Case{65, 64, 64, 64, 1, 1}, Case{17, 100, 8, 17, 3, 1},
        Case{65535, 1u << 20, 1, 65535, 65535, 1}, Case{65536, 1u << 20, 1, 65536, 65535, 2}}) {
    CAPTURE(one.items, one.capacity, one.itemsOfGroup);
    const gpu::BufferRef count = countBuffer(f.frame(), "count");
    CHECK(wordsOf(count, 5) == std::vector<std::uint32_t>(5, 0));
    count->uploadValues(std::span<const std::uint32_t>(&one.items, 1));
    finishCount(f.frame(), count, one.capacity, one.itemsOfGroup);
    CHECK(wordsOf(count, 5) == std::vector<std::uint32_t>{one.kept, one.x, one.y, 1, one.items});
  }
}

TEST_CASE("a scan puts the sum of the numbers before in place of each number, column by column") {
  Toolkit f;
  std::mt19937 random(7);
  for (const std::uint32_t items : {1u, 2u, 63u, 64u, 65u, 129u, 4097u})
    for (const std::uint32_t columns : {1u, 2u, 3u}) {
      CAPTURE(items, columns);
      std::vector<std::uint32_t> numbers(items * columns), expected(items * columns), sums(columns, 0);
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        numbers[i] = random() % 1000;
        expected[i] = sums[i % columns];
        sums[i % columns] += numbers[i];
      }
      for (const bool withTotals : {false, true}) {
        const gpu::BufferRef buffer = f.frame().uploaded(numbers, "numbers"),
                             totals = withTotals ? f.frame().uploaded(
                                                       std::vector<std::uint32_t>(columns + 1, 99), "totals")
                                                 : nullptr;
        scan(f.frame(), buffer, items, static_cast<int>(columns), totals);
        CHECK(wordsOf(buffer, numbers.size()) == expected);
        if (!withTotals) continue;
        std::vector<std::uint32_t> all = sums;
        all.push_back(99);  // nothing behind the totals is written
        CHECK(wordsOf(totals, columns + 1) == all);
      }
    }
}

TEST_CASE("every occupied voxel has one slot, which knows its voxel and how many fragments lie in it") {
  Toolkit f;
  // Several fragments in some voxels, one in others; more voxels than a guess for so small a grid holds would
  // be cut off, and the frame is rendered again with room for all.
  constexpr int kSide = 9;
  std::mt19937 random(3);
  std::map<std::uint32_t, std::uint32_t> expected;
  std::vector<FragmentData> fragments(700);
  for (FragmentData& fragment : fragments) {
    fragment = {};
    fragment.voxel = random() % kSide | random() % kSide << 10 | random() % kSide << 20;
    ++expected[fragment.voxel];
  }
  VoxelFragments list;
  list.grid = {glm::vec3(0.0f), 1.0f, glm::ivec3(kSide)};
  list.capacity = fragments.size();
  list.fragments = f.frame().uploaded(fragments, "list");
  list.count = countBuffer(f.frame(), "count");
  const auto count = static_cast<std::uint32_t>(fragments.size());
  list.count->uploadValues(std::span<const std::uint32_t>(&count, 1));
  finishCount(f.frame(), list.count, list.capacity);
  f.harness->setInput<VoxelFragments>("fragments", list);
  for (const std::uint64_t guess : {std::uint64_t{0}, std::uint64_t{1}}) {
    f.pass().room = guess;
    f.pass().runs = 0;
    f.harness->run();
    CHECK(f.pass().runs == (guess == 0 ? 1 : 2));
    const VoxelSlots& slots = f.pass().slots;
    const std::size_t occupied = wordsOf(slots.count, 1).front();
    REQUIRE(occupied == expected.size());
    REQUIRE(slots.room >= occupied);
    const std::vector<std::uint32_t> voxels = wordsOf(slots.voxels, occupied),
                                     counts = wordsOf(slots.fragments, occupied);
    std::map<std::uint32_t, std::uint32_t> found;
    std::vector<std::uint32_t> numbers(static_cast<std::size_t>(kSide * kSide * kSide));
    const std::vector<std::byte> bytes = slots.numbers->download(0);
    REQUIRE(bytes.size() == numbers.size() * sizeof(std::uint32_t));
    std::memcpy(numbers.data(), bytes.data(), bytes.size());
    std::size_t numbered = 0;
    for (const std::uint32_t number : numbers) numbered += number != 0 ? 1 : 0;
    CHECK(numbered == occupied);
    for (std::size_t slot = 0; slot < occupied; ++slot) {
      found[voxels[slot]] = counts[slot];
      const glm::ivec3 at = FragmentData::tenBits(voxels[slot]);
      CHECK(numbers[static_cast<std::size_t>((at.z * kSide + at.y) * kSide + at.x)] == slot + 1);
    }
    CHECK(found == expected);
  }
}

TEST_CASE("a list that shaders cannot number is refused") {
  requireListable(0x7fffffffu);
  CHECK_THROWS_AS(requireListable(0x80000000u), Error);
}
