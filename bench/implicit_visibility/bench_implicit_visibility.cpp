// Times of implicit visibility: growth with elements, the hierarchy over all pairs, two threads over one, the
// cost of a moving object and of a moving camera, `fill centre` over `one`, a bounce over a plain loop on the
// CPU, and lists of lights over all bins. Printed are medians and quartiles of ratios of times that were
// taken in turns.
// usage: bench_implicit_visibility [--quick | REPEATS] (default: 5), from the project's folder.
// --quick: seconds of work, whose figures mean nothing, for the tests
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "../../techniques/implicit_visibility/links/element_light.h"
#include "../../techniques/implicit_visibility/links/element_links.h"
#include "../timed_pipelines.h"
#include "lumivox/base/error.h"
#include "lumivox/pipeline/ports.h"

namespace {

using namespace lumivox;
using namespace lumivox::implicit_visibility;

// Passes up to the links: by the hierarchy with its defaults, with one bin per element, and from all pairs.
constexpr const char* kLinks = R"(
pipeline "links" {
  param elements 4096 in 16..1048576
  param bins 8 in 1..64
  pass elements implicit_visibility.elements { elements $elements }
  pass pairs implicit_visibility.create_links { elements elements.elements  bins $bins }
  pass links implicit_visibility.push_links { elements elements.elements  links pairs.links }
  pass links_one implicit_visibility.push_links { elements elements.elements  links pairs.links  fill one }
  pass all implicit_visibility.create_links { elements elements.elements  bins $bins  method all_pairs }
  pass all_links implicit_visibility.push_links { elements elements.elements  links all.links }
}
)";

/// The number of links that all leaves rasterise: of each leaf those of itself and of all nodes above it.
double rasterised(const ElementTree& tree, const ElementLinks& pairs) {
  std::vector<double> ofNode(tree.nodeCount, 0.0);  // including those of the nodes above it
  double sum = 0.0;
  for (std::uint32_t node = tree.nodeCount; node-- > 0;) {
    const std::uint32_t parent = tree.parents[node];
    if (parent != kNoElement) ofNode[node] = ofNode[parent];
    for (const auto& lists : {pairs.stillPartners, pairs.movingPartners})
      ofNode[node] += static_cast<double>((*lists)[node].size());
    if (tree.isLeaf(node)) sum += ofNode[node];
  }
  return sum;
}

std::vector<std::string> settingsOf(int elements, int bins) {
  return {fmt::format("elements={}", elements), fmt::format("bins={}", bins)};
}

/// Growth of links, pairs, time and bytes with the number of elements.
void growth(Machine& machine, const Scene& scene, const std::vector<int>& elements, int bins, bool allPairs) {
  const Pipeline pipeline = Pipeline::parse(kLinks, "bench.pipeline");
  fmt::print("growth, 6 x {} x {} bins, {}\n", bins, bins, allPairs ? "all pairs" : "hierarchy");
  Growth growth;
  for (const int wanted : elements) {
    Bench bench(machine, scene, pipeline, settingsOf(wanted, bins));
    bench.keep("elements", "elements");
    bench.keep(allPairs ? "all_links" : "links", "links");
    if (!allPairs) bench.keep("pairs", "links");
    std::vector<double> ms;
    for (const Times& frame : bench.severalAfresh())
      ms.push_back(sumOf(frame, allPairs ? std::vector<std::string>{"all", "all_links"}
                                         : std::vector<std::string>{"pairs", "links"}));
    const auto& links = bench.made<ElementLinks>(allPairs ? "all_links" : "links", "links");
    const double leaves = bench.made<SurfaceElements>("elements", "elements").leafCount;
    double bytes = static_cast<double>(links.seen->values.size() * sizeof(ElementLink)),
           pairs = leaves * leaves / 2, seen = leaves * leaves;
    if (!allPairs) {
      const auto& made = bench.made<ElementLinks>("pairs", "links");
      const double partners =
          static_cast<double>(made.stillPartners->values.size() + made.movingPartners->values.size());
      bytes += partners * sizeof(std::uint32_t);
      pairs = partners / 2;
      seen = rasterised(*bench.made<SurfaceElements>("elements", "elements").tree, made);
    }
    growth.add("pairs", leaves, pairs);
    growth.add("links rasterised at leaves", leaves, seen);
    growth.add("links that stay", leaves, static_cast<double>(links.seen->values.size()));
    growth.add("bytes of pairs and links", leaves, bytes);
    growth.add("time, ms", leaves, spreadOf(ms).median);
  }
  growth.print();
}

void overAllPairs(Machine& machine, const Scene& scene, int elements, int bins) {
  const Pipeline pipeline = Pipeline::parse(kLinks, "bench.pipeline");
  Bench bench(machine, scene, pipeline, settingsOf(elements, bins));
  for (const char* pass : {"links", "links_one", "all_links"}) bench.keep(pass, "links");
  const std::vector<Times> frames = bench.severalAfresh();
  row(fmt::format("hierarchy over all pairs, {} elements, 6 x {} x {} bins", elements, bins, bins),
      inWords(ratios(frames, {"pairs", "links"}, {"all", "all_links"})));
  row("  fill centre over one", inWords(ratios(frames, {"links"}, {"links_one"})));
}

void threads(Machine& machine, const Scene& scene, int elements, int bins) {
  const Pipeline pipeline = Pipeline::parse(kLinks, "bench.pipeline");
  Bench bench(machine, scene, pipeline, settingsOf(elements, bins));
  bench.keep("links", "links");
  const auto msWith = [&](std::size_t count) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, count);
    return sumOf(bench.afresh(), {"pairs", "links"});
  };
  msWith(2);
  std::vector<double> faster;
  for (int i = 0; i < machine.repeats; ++i) {
    const double one = msWith(1);
    faster.push_back(one / msWith(2));
  }
  row(fmt::format("two threads, times as fast as one ({} processors)", std::thread::hardware_concurrency()),
      inWords(faster));
}

void incremental(Machine& machine, const Scene& scene, int elements, int bins) {
  const Pipeline pipeline = Pipeline::parse(kLinks, "bench.pipeline");
  Bench bench(machine, scene, pipeline, settingsOf(elements, bins));
  bench.keep("links", "links");
  bench.keep("elements", "elements");
  bench.afresh();
  std::vector<double> shares;
  for (int i = 1; i <= machine.repeats; ++i) {
    const double full = sumOf(bench.afresh(0.1 * i), {"pairs", "links"});
    shares.push_back(sumOf(bench.at(0.1 * i + 0.05), {"pairs", "links"}) / full);
  }
  const auto& made = bench.made<SurfaceElements>("elements", "elements");
  int moving = 0;
  for (int leaf = 0; leaf < made.leafCount; ++leaf)
    moving += !made.state->still[static_cast<std::size_t>(leaf)];
  row(fmt::format("spinning_box: incremental over full ({:.1f} % of elements move)",
                  100.0 * moving / made.leafCount),
      inWords(shares));
}

/// As published in Table 1: times of preprocessing and of the work in every frame.
void madeOnce(Machine& machine, Scene scene, int bins) {
  for (Object& object : scene.objects) object.motion = RigidMotion{.angularSpeed = 0.5};
  scene.hash = {};
  Bench bench(machine, scene, Pipeline::load("scenes/reproductions/002_table_1.pipeline"),
              {fmt::format("bins={}", bins)});
  bench.afresh();
  std::vector<double> once, create, push, light;
  for (int i = 1; i <= machine.repeats; ++i) {
    const Times first = bench.afresh(0.1 * i), next = bench.at(0.1 * i + 0.05);
    const double update = next.at("elements");
    once.push_back((first.at("elements") - update) / update);
    create.push_back(next.at("pairs") / update);
    push.push_back(next.at("links") / update);
    light.push_back(next.at("illuminate") / update);
  }
  fmt::print("urn_fine as published, every vertex moves, 6 x {} x {} bins, over the update of elements\n",
             bins, bins);
  row("  hierarchy of elements, made once", inWords(once));
  row("  create links", inWords(create));
  row("  refine and push links", inWords(push));
  row("  illumination", inWords(light));
}

void cameraMove(Machine& machine, Scene scene, const std::vector<std::string>& settings, int size) {
  Camera& camera = scene.cameras.front();
  camera.keys = {{0.0, camera.eye, camera.target}, {1.0, camera.eye + glm::dvec3(0.05, 0, 0), camera.target}};
  scene.hash = {};
  Bench bench(machine, scene, Pipeline::load("scenes/pipelines/implicit_visibility.pipeline"), settings,
              size);
  bench.afresh();
  std::vector<double> shares;
  for (int i = 0; i < machine.repeats; ++i) {
    const double first = total(bench.afresh(0.0));
    shares.push_back(total(bench.at(0.5)) / first);
  }
  row(fmt::format("cornell, {} x {} pixels: frame after a camera move over first frame", size, size),
      inWords(shares));
}

/// One bounce on the CPU over the links and the radiance of the passes, leaf by leaf on one thread. Returns
/// the ms and the mean irradiance of the fronts, without which the compiler could remove the work.
std::pair<double, double> plainGather(const SurfaceElements& elements, const ElementLinks& links,
                                      const std::vector<float>& radiance) {
  const ElementTree& tree = *elements.tree;
  const ElementState& state = *elements.state;
  const BinTable table(DirectionBins(links.bins, links.mapping));
  const auto texel = [&](std::size_t number) {
    return glm::vec3(radiance[4 * number], radiance[4 * number + 1], radiance[4 * number + 2]);
  };
  std::vector<float> scales;
  for (std::uint32_t leaf = 0; leaf < tree.leafCount; ++leaf)
    scales.push_back(table.projectionScale(state.normal[leaf]));
  std::vector<glm::vec3> irradiance(2 * std::size_t{tree.leafCount});
  const auto start = std::chrono::steady_clock::now();
  for (std::uint32_t leaf = 0; leaf < tree.leafCount; ++leaf) {
    glm::vec3 sides[2] = {glm::vec3(0.0f), glm::vec3(0.0f)};
    for (const ElementLink& link : (*links.seen)[leaf]) {
      const glm::vec4& bin = table.bins[link.bin()];
      const float weight = bin.w * scales[leaf] * glm::dot(glm::vec3(bin), state.normal[leaf]);
      const glm::vec3 away = glm::normalize(state.position[leaf] - state.position[link.node]);
      glm::vec3 sent(0.0f);
      if (!tree.isGroup(link.node)) {
        sent = texel(2 * std::size_t{link.node} + (glm::dot(state.normal[link.node], away) >= 0.0f ? 0 : 1));
      } else {
        const std::size_t first =
            2 * std::size_t{tree.firstGroup} + 6 * std::size_t{link.node - tree.firstGroup};
        for (int axis = 0; axis < 3; ++axis)
          sent += away[axis] * away[axis] *
                  texel(first + static_cast<std::size_t>(2 * axis + (away[axis] < 0.0f)));
      }
      sides[weight > 0.0f ? 0 : 1] += std::abs(weight) * sent;
    }
    irradiance[2 * std::size_t{leaf}] = sides[0];
    irradiance[2 * std::size_t{leaf} + 1] = sides[1];
  }
  const std::chrono::duration<double, std::milli> ms = std::chrono::steady_clock::now() - start;
  double mean = 0.0;
  for (std::size_t leaf = 0; leaf < tree.leafCount; ++leaf) mean += irradiance[2 * leaf].x / tree.leafCount;
  return {ms.count(), mean};
}

void gather(Machine& machine, const Scene& scene, int elements, int bins) {
  constexpr int kMore = 8;
  const Pipeline pipeline = Pipeline::load("scenes/pipelines/implicit_visibility.pipeline");
  std::vector<std::string> settings = settingsOf(elements, bins);
  Bench one(machine, scene, pipeline, settings);
  settings.push_back(fmt::format("bounces={}", 1 + kMore));
  Bench more(machine, scene, pipeline, settings);
  one.keep("elements", "elements");
  one.keep("links", "links");
  one.keep("illuminate", "light");
  one.afresh(), more.afresh();
  const std::vector<float> radiance =
      one.made<ElementLight>("illuminate", "light").radiance->downloadFloats(0);
  std::vector<double> shares, single;
  for (int i = 0; i < machine.repeats; ++i) {
    const double bounce = (more.afresh().at("illuminate") - one.afresh().at("illuminate")) / kMore;
    const auto [ms, mean] = plainGather(one.made<SurfaceElements>("elements", "elements"),
                                        one.made<ElementLinks>("links", "links"), radiance);
    if (!std::isfinite(mean)) throw Error("the plain loop gathered what is not finite");
    shares.push_back(bounce / ms);
  }
  row(fmt::format("a bounce with its pull-up, {} elements, 6 x {} x {} bins, over a plain loop", elements,
                  bins, bins),
      inWords(shares));
}

void lightLists(Machine& machine, const Scene& scene, int elements, int bins) {
  const Pipeline pipeline = Pipeline::load("scenes/pipelines/implicit_visibility_lights.pipeline");
  std::vector<std::string> settings = settingsOf(elements, bins);
  Bench lists(machine, scene, pipeline, settings);
  settings.push_back("light_lists=off");
  Bench all(machine, scene, pipeline, settings);
  const auto directBits = [](Bench& bench) {
    return bench.made<ElementLight>("illuminate", "light").directIrradiance->downloadFloats(0);
  };
  for (Bench* bench : {&lists, &all}) {
    bench->keep("illuminate", "light");
    bench->afresh();
  }
  const bool same = directBits(lists) == directBits(all);
  std::vector<double> shares;
  for (int i = 0; i < machine.repeats; ++i)
    shares.push_back(lists.afresh().at("illuminate") / all.afresh().at("illuminate"));
  row(fmt::format("lists of lights over all bins, illuminate ({})", same ? "same bits" : "OTHER BITS"),
      inWords(shares));
  if (!same) throw Error("light by lists differs from that of all bins");
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const bool quick = argc > 1 && std::string_view(argv[1]) == "--quick";
    Machine machine;
    machine.repeats = quick ? 1 : argc > 1 ? repeatsOf(argv[1], "bench_implicit_visibility") : 5;
    const Scene cornell = loadScene("scenes/cornell.scene"), box = loadScene("scenes/spinning_box.scene");
    fmt::print("{} repeats in turns, median [quartiles], on {}\n", machine.repeats,
               machine.device.info().renderer);
    if (quick) {
      growth(machine, cornell, {64, 128, 256}, 4, false);
      growth(machine, cornell, {64, 128, 256}, 4, true);
    } else {
      growth(machine, cornell, {4096, 16384, 65536}, 8, false);
      growth(machine, cornell, {1024, 2048, 4096}, 16, false);
      growth(machine, cornell, {1024, 4096, 16384}, 8, true);
    }
    fmt::print("ratios\n");
    overAllPairs(machine, cornell, quick ? 128 : 4096, quick ? 4 : 12);
    if (!quick) overAllPairs(machine, cornell, 16384, 8);
    const int elements = quick ? 128 : 4096, bins = quick ? 4 : 8;
    threads(machine, cornell, elements, bins);
    incremental(machine, box, elements, bins);
    for (const int published : {8, 12, 16})
      if (!quick || published == 8) madeOnce(machine, loadScene("scenes/urn_fine.scene"), published);
    cameraMove(machine, cornell, settingsOf(elements, bins), quick ? 16 : 256);
    gather(machine, cornell, elements, bins);
    lightLists(machine, cornell, elements, bins);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_implicit_visibility: {}\n", error.what());
    return 2;
  }
  return 0;
}
