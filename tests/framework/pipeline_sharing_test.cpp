// What executors of one device have in common, and what stays their own: read-only parts of the scene, and
// memory that no pass uses at the moment.
#include <optional>

#include "lumivox/base/error.h"
#include "lumivox/pipeline/gpu_scene.h"
#include "pipeline/pool.h"
#include "pipeline_toys.h"
#include "support/scene_builder.h"
#include "support/techniques.h"

using namespace lumivox;
using namespace lumivox::test;
using Catch::Matchers::Contains;

namespace {

/// Paints where in the world the device has the first vertex of the scene, and its first material's red.
struct ShowScene : Toy {
  using Toy::Toy;
  Out<Image> radiance{this, "radiance", Contributes::direct};
  Reads readsFrom() const override { return Reads::geometry | Reads::materials | Reads::lights; }
  void run(PassContext& frame) override {
    const GpuScene& scene = frame.scene();
    const glm::mat4 toWorld = scene.objects().downloadValues<ObjectData>().at(0).toWorld;
    const std::vector<float> positions = scene.positions().downloadValues<float>();
    const glm::vec4 vertex = toWorld * glm::vec4(positions[0], positions[1], positions[2], 1.0f);
    const float red = scene.materials().downloadValues<MaterialData>().at(0).diffuse.r;
    radiance = Image{frame.image("image")};
    const auto x = static_cast<float>(vertex.x + frame.snapshot().origin.x);
    radiance.value().texture->clear(glm::vec4(x, red, 0.0f, 0.0f));
  }
};

/// Paints what it has written to a volume that it needs only meanwhile, of the shape of a grid.
struct Work : Toy {
  using Toy::Toy;
  Param<float> value{this, "value", 1.0f, {-10.0f, 10.0f}, "", "radiance"};
  Out<Image> radiance{this, "radiance", Contributes::direct};
  void run(PassContext& frame) override {
    const gpu::TextureRef volume =
        frame.texture({gpu::TextureKind::d3, gpu::Format::rgba32f, 16, 16, 16, 1}, "volume");
    volume->clear(glm::vec4(value));
    radiance = paint(frame, volume->downloadFloats().front());
  }
};

constexpr const char* kShow = "pass show toy.show { }\noutput direct show.radiance";
constexpr const char* kWork =
    "param value 2\npass work toy.work { value $value }\noutput direct work.radiance";
constexpr const char* kWorkAndGrid =
    "param value 2\npass work toy.work { value $value }\npass voxels toy.voxels { resolution 16 }\noutput "
    "direct work.radiance";

struct Room {
  TestTechniques toys;
  Scene scene = litRoom(8, 8);

  Room() {
    toys.add<ShowScene>("toy", "show");
    toys.add<Voxels>("toy", "voxels");
    toys.add<Work>("toy", "work");
  }
  std::unique_ptr<PipelineExecutor> executor(const std::string& body, RenderOptions options = {},
                                             gpu::Device& on = device()) {
    return executorOf(scene, body, std::move(options), on);
  }
  std::unique_ptr<PipelineExecutor> executorOf(const Scene& shown, const std::string& body,
                                               RenderOptions options = {}, gpu::Device& on = device()) {
    return std::make_unique<PipelineExecutor>(
        on, toys, shown, Pipeline::parse("pipeline \"Toy\" {\n" + body + "\n}\n", "toy.pipeline"), options);
  }
};

glm::vec2 shown(PipelineExecutor& executor, double time = 0.0) {
  const ImageBuffer image = executor.render(time).outputs.at("direct");
  return {image.at(0, 0, 0), image.at(0, 0, 1)};
}

/// Bytes on the device since it was made.
class Since {
 public:
  explicit Since(gpu::Device& of = device()) : device_(of), before_(of.allocatedBytes()) {}
  std::uint64_t bytes() const { return device_.allocatedBytes() - before_; }

 private:
  gpu::Device& device_;
  std::uint64_t before_;
};

RenderOptions valued(double value, std::shared_ptr<TransientMemory> memory = nullptr) {
  RenderOptions options;
  options.parameters["value"].number = value;
  options.transientMemory = std::move(memory);
  return options;
}

}  // namespace

TEST_CASE("executors on one scene have its unchanging parts once, and each reports its bytes as if alone") {
  Room room;
  const Since start;
  auto first = room.executor(kShow);
  const FrameResult alone = first->render(0.0);
  const MemoryUse use = first->memory();
  CHECK(start.bytes() == use.bytes);
  CHECK(alone.peakBytes == use.bytes);
  // Positions and normals of 12 bytes a vertex, texture coordinates, indices, materials; a white texel.
  const Scene& s = room.scene;
  CHECK(use.sharedBytes == s.positions.size() * 32 + s.indices.size() * 4 + s.materials.size() * 48 + 8);

  auto second = room.executor(kShow);
  const FrameResult beside = second->render(0.0);
  CHECK(start.bytes() == use.bytes + (use.bytes - use.sharedBytes));
  CHECK(beside.peakBytes == alone.peakBytes);
  CHECK(second->memory().bytes == use.bytes);
  CHECK(second->memory().sharedBytes == use.sharedBytes);
  CHECK(beside.outputs.at("direct").values() == alone.outputs.at("direct").values());

  first.reset();
  CHECK(start.bytes() == use.bytes);
  CHECK(second->memory().bytes == use.bytes);
  CHECK(shown(*second) == glm::vec2(0.0f, 0.73f));
  second.reset();
  CHECK(start.bytes() == 0);
}

TEST_CASE("equal bits are shared by scenes that know nothing of each other, and other bits are not") {
  Room room;
  Scene copy = room.scene, other = room.scene;
  other.materials[0].diffuse.r = 0.25f;
  const Since start;
  auto first = room.executor(kShow);
  shown(*first);
  const MemoryUse use = first->memory();
  auto same = room.executorOf(copy, kShow);
  shown(*same);
  CHECK(start.bytes() == 2 * use.bytes - use.sharedBytes);
  auto different = room.executorOf(other, kShow);
  CHECK(shown(*different).y == 0.25f);
  CHECK(shown(*first).y == 0.73f);
  CHECK(start.bytes() == 3 * use.bytes - 2 * use.sharedBytes + room.scene.materials.size() * 48);
}

TEST_CASE("what moves in one executor does not show in another") {
  Room room;
  room.scene.objects[0].motion = RigidMotion{{0, 1, 0}, 0.0, {0, 0, 0}, {1, 0, 0}};
  auto early = room.executor(kShow), late = room.executor(kShow);
  for (int round = 0; round < 2; ++round) {
    CHECK(shown(*early, 0.0).x == 0.0f);
    CHECK(shown(*late, 2.0).x == 2.0f);
    early->invalidate();
    CHECK(shown(*early, 0.0).x == 0.0f);
    late->invalidate();
  }
}

TEST_CASE("vertices that deform are each executor's own, and the rest of the scene is shared") {
  Room room;
  Object& object = room.scene.objects[0];
  VertexSequence& sequence = object.sequence.emplace();
  for (const float shift : {0.0f, 1.0f}) {
    std::vector<glm::vec3> moved(room.scene.positions.begin() + object.firstVertex,
                                 room.scene.positions.begin() + object.firstVertex + object.vertexCount);
    for (glm::vec3& position : moved) position.x += shift;
    sequence.positions.push_back(moved);
    sequence.normals.emplace_back(moved.size(), glm::vec3(0, 1, 0));
  }
  const Since start;
  auto early = room.executor(kShow), late = room.executor(kShow);
  CHECK(shown(*early, 0.0).x == 0.0f);
  const MemoryUse use = early->memory();
  CHECK(shown(*late, 1.0 / 24.0).x == 1.0f);
  early->invalidate();
  CHECK(shown(*early, 0.0).x == 0.0f);
  const Scene& s = room.scene;
  CHECK(use.sharedBytes == s.positions.size() * 8 + s.indices.size() * 4 + s.materials.size() * 48 + 8);
  CHECK(start.bytes() == 2 * use.bytes - use.sharedBytes);
}

TEST_CASE("another scene of one executor leaves the others as they were, and the scene before may go") {
  Room room;
  auto old = std::make_unique<Scene>(room.scene);
  auto changing = room.executorOf(*old, kShow), staying = room.executor(kShow);
  CHECK(shown(*changing) == shown(*staying));
  // Only a light differs: what is on the device stays.
  Scene lit = room.scene;
  lit.lights.push_back({"bulb", LightKind::point, {0.5, 0.5, 0.5}, {0, -1, 0}, glm::vec3(1.0f)});
  changing->setScene(lit);
  old->objects.clear();
  old.reset();
  CHECK(shown(*changing) == glm::vec2(0.0f, 0.73f));
  Scene moved = lit;
  for (glm::vec3& position : moved.positions) position.x += 3.0f;
  moved.materials[0].diffuse.r = 0.5f;
  changing->setScene(moved);
  CHECK(shown(*changing) == glm::vec2(3.0f, 0.5f));
  staying->invalidate();
  CHECK(shown(*staying) == glm::vec2(0.0f, 0.73f));
}

TEST_CASE("a limit of memory counts what is shared once, and who does not fit leaves nothing behind") {
  Room room;
  MemoryUse use;
  {
    auto alone = room.executor(kShow);
    shown(*alone);
    use = alone->memory();
  }
  const std::uint64_t forTwo = 2 * use.bytes - use.sharedBytes;
  for (const bool enough : {true, false}) {
    CAPTURE(enough);
    gpu::DeviceOptions options;
    options.memoryBytes = enough ? forTwo : forTwo - 1;
    gpu::Device limited(options);
    auto first = room.executor(kShow, {}, limited);
    CHECK(shown(*first) == glm::vec2(0.0f, 0.73f));
    // Another device has its own.
    CHECK(limited.allocatedBytes() == use.bytes);
    auto second = room.executor(kShow, {}, limited);
    if (enough) {
      CHECK(shown(*second) == glm::vec2(0.0f, 0.73f));
      continue;
    }
    CHECK_THROWS_WITH(second->render(0.0), Contains("of the limit of"));
    second.reset();
    CHECK(limited.allocatedBytes() == use.bytes);
    first->invalidate();
    CHECK(shown(*first) == glm::vec2(0.0f, 0.73f));
    first.reset();
    CHECK(limited.allocatedBytes() == 0);
  }
}

TEST_CASE("a scene that does not fit leaves nothing behind, and one that does comes after it") {
  Room room;
  gpu::DeviceOptions options;
  options.memoryBytes = 4096;
  gpu::Device limited(options);
  Scene large = room.scene;
  large.indices.insert(large.indices.end(), 3000, 0u);
  auto executor = room.executorOf(large, kShow, {}, limited);
  CHECK_THROWS_WITH(executor->render(0.0), Contains("scene indices"));
  CHECK(limited.allocatedBytes() == 0);
  CHECK(executor->memory().bytes == 0);
  Scene small = room.scene;
  small.positions.resize(3);
  small.normals.resize(3);
  small.texcoords.resize(3);
  small.indices = {0, 1, 2};
  small.objects.resize(1);
  small.objects[0].vertexCount = 3;
  small.objects[0].parts = {{0, 0, 3}};
  executor->setScene(small);
  CHECK(shown(*executor) == glm::vec2(0.0f, 0.73f));
}

TEST_CASE("executors that take turns wait with the memory of the one that needs most") {
  Room room;
  FrameResult alone[2];
  MemoryUse use;
  const double values[] = {2.0, 5.0};
  for (int i = 0; i < 2; ++i) {
    auto executor = room.executor(kWork, valued(values[i]));
    executor->render(0.0);
    executor->invalidate();
    alone[i] = executor->render(0.0);
    use = executor->memory();
  }
  const Since start;
  const auto memory = std::make_shared<TransientMemory>(device());
  auto first = room.executor(kWork, valued(values[0], memory)),
       second = room.executor(kWork, valued(values[1], memory));
  first->render(0.0);
  const std::uint64_t waiting = memory->waitingBytes();
  REQUIRE(waiting > 0);
  CHECK(start.bytes() == use.bytes);
  second->render(0.0);
  CHECK(memory->waitingBytes() == waiting);
  CHECK(start.bytes() == 2 * use.bytes - waiting);
  // Images, numbers and results are those of one that is alone.
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < 2; ++i) {
      PipelineExecutor& executor = i == 0 ? *first : *second;
      executor.invalidate();
      const FrameResult frame = executor.render(0.0);
      CHECK(frame.outputs.at("direct").values() == alone[i].outputs.at("direct").values());
      CHECK(frame.peakBytes == alone[i].peakBytes);
      CHECK(executor.memory().bytes == use.bytes);
      CHECK(executor.explain().poolBytes == use.bytes);
    }
  }
  // Nothing was asked of the device meanwhile.
  device().resetPeak();
  first->invalidate();
  first->render(0.0);
  CHECK(device().peakBytes() == device().allocatedBytes());
  first.reset();
  CHECK(start.bytes() == use.bytes);
  second.reset();
  CHECK(start.bytes() == 0);
}

TEST_CASE("what one executor keeps is not another's, and no later frame waits for memory because of it") {
  Room room;
  const auto memory = std::make_shared<TransientMemory>(device());
  const Since start;
  auto first = room.executor(kWork, valued(2.0, memory)),
       keeper = room.executor(kWorkAndGrid, valued(5.0, memory));
  first->render(0.0);
  const std::uint64_t bytes = first->memory().bytes;
  keeper->keepOutput("voxels", "grid");
  keeper->render(0.0);
  // The grid that the keeper holds is missing from what waits, and was made once more for the first.
  device().resetPeak();
  const auto gridOf = [](PipelineExecutor& executor) {
    return static_cast<const Out<RadianceGrid>*>(executor.output("voxels", "grid"))->value().radiance;
  };
  const gpu::TextureRef grid = gridOf(*keeper);
  grid->clear(glm::vec4(7.0f));
  for (int round = 0; round < 3; ++round) {
    first->invalidate();
    CHECK(first->render(0.0).outputs.at("direct").at(0, 0, 0) == 2.0f);
  }
  CHECK(device().peakBytes() == device().allocatedBytes());
  CHECK(first->memory().bytes == bytes);
  CHECK(grid->downloadFloats().front() == 7.0f);
  CHECK(gridOf(*keeper) == grid);
  first.reset();
  CHECK(start.bytes() == keeper->memory().bytes);
}

TEST_CASE("memory of one device is refused by an executor on another") {
  Room room;
  gpu::Device other;
  const auto memory = std::make_shared<TransientMemory>(device());
  CHECK_THROWS_WITH(room.executor(kWork, valued(2.0, memory), other), Contains("of another device"));
}
