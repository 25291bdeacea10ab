// Pipeline texts: parsing, binding to the passes of technique libraries, pruning, running.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lumivox/base/hash.h"
#include "lumivox/base/image.h"
#include "lumivox/dsl/document.h"
#include "lumivox/dsl/schema.h"
#include "lumivox/pipeline/contributes.h"
#include "lumivox/pipeline/technique_source.h"
#include "lumivox/scene/scene.h"
#include "lumivox/shader/work.h"

namespace lumivox {

namespace gpu {
class Device;
class Texture;
}  // namespace gpu
namespace shader {
class ShaderLibrary;
}
// Of pipeline/pass.h, which few of those need who load pipelines and run them.
class OutBase;
class Pass;
class PassContext;
class TransientMemory;  ///< of pipeline/pool.h
template <class Port>
class Out;

/// One value of a pipeline parameter.
struct ParameterValue {
  double number = 0.0;       ///< in base units
  std::string word;          ///< non-empty: a word in place of a number
  dsl::Dimension dimension;  ///< of the unit that the number was written with
  std::string text() const;  ///< as settings() reads it: the number in base units, or the word
  bool operator==(const ParameterValue&) const = default;
};
using ParameterValues = std::map<std::string, ParameterValue>;

struct PipelineParameter {
  std::string name;
  ParameterValue value;              ///< default
  std::optional<double> low, high;   ///< declared range
  std::vector<std::string> choices;  ///< declared words, or numbers as text
  /// "must be in 16..512" when the value does not fit the declaration, else empty.
  std::string misfit(const ParameterValue& candidate) const;
};

/// An axis of sweeps that is not a parameter: the number of accumulated frames of the still scene, from 1 on.
inline constexpr const char* kAccumulatedFrames = "frames";
inline constexpr int kMostAccumulatedFrames = 1 << 16;

/// `sweep NAME { parameter [values] ... }`: the grid over its lists. `sweep NAME list { ... }`: the first
/// values of all lists together, then the second ones, and so on.
struct Sweep {
  std::string name;
  bool isList = false;  ///< then all axes have the same number of values
  std::vector<std::pair<std::string, std::vector<ParameterValue>>> axes;
  std::vector<std::uint64_t> seeds;             ///< each is a run of its own; empty: the command line's
  std::vector<ParameterValues> points() const;  ///< in text order, the last axis fastest; one without axes
};

struct PassText {
  std::string name, technique, pass;
  SourcePlace place;
  const dsl::Block* block = nullptr;
};

/// A parsed pipeline text, not yet bound.
class Pipeline {
 public:
  /// Throws DiagnosticsError with every finding that needs no technique library.
  static Pipeline load(const std::filesystem::path& file);
  static Pipeline parse(std::string source, std::filesystem::path file);

  std::string name;  ///< the string in the text
  std::filesystem::path file;
  ContentHash hash;  ///< of the text with its includes
  std::vector<PipelineParameter> parameters;
  std::vector<PassText> passes;
  struct Output {
    std::string name, pass, port;
    SourcePlace place;
  };
  std::vector<Output> outputs;
  std::vector<Sweep> sweeps;
  std::shared_ptr<const dsl::Document> document;

  /// Parses "name=value" settings and returns them; Error for an unknown parameter (with the nearest) or a
  /// value out of its range.
  ParameterValues settings(const std::vector<std::string>& assignments) const;
  /// Names of the techniques that it needs, each once, in text order.
  std::vector<std::string> techniques() const;
};

/// Tables of the pipeline grammar, for check, describe and the reference.
const std::vector<dsl::BlockSpecification>& pipelineSpecifications();
/// Tables of the scene grammar are in scene/text.h.

/// All findings of a pipeline against the techniques: unknown techniques, passes, ports, parameters, kinds,
/// cycles, ranges.
void checkPipeline(const Pipeline& pipeline, TechniqueSource& techniques);

struct RenderOptions {
  bool keepEverything = false;
  ParameterValues parameters;       ///< over the defaults
  std::vector<std::string> wanted;  ///< output names; empty: all
  bool wantsOutputs = true;         ///< false: none of them, only what keepOutput() names
  std::uint64_t seed = 1;
  bool health = false;     ///< scan every pass output for NaN, Inf and negative values; not part of the times
  bool countWork = false;  ///< count what every pass does: the same images, several times slower
  /// Passes find their results of the previous frame (PassContext::history(), accumulated(), history inputs).
  /// Off: every frame is rendered as if it were the first, so that frame N alone equals frame N of a
  /// sequence.
  bool accumulate = false;
  /// For debugging: every frame is rendered a second time from scratch, and FrameResult::readsFindings names
  /// passes whose Reads, Needs or uses() lack a dependency. Needs the memory of both.
  bool checkReads = false;
  bool interactive =
      false;  ///< camera, lights and objects may change in ways that the scene text does not announce
  std::string camera;
  int width = 0, height = 0;  ///< 0: the camera's
  /// The pool of unused resources, shared by several executors of one device, of which one renders at a time.
  /// Null: each has its own.
  std::shared_ptr<TransientMemory> transientMemory{};
};

/// Bytes of an executor's textures and buffers, as if it were alone on the device.
struct MemoryUse {
  std::uint64_t bytes = 0;  ///< the scene's included
  /// The part of `bytes` for read-only parts of the scene, which are on the device once for all executors.
  std::uint64_t sharedBytes = 0;
};

struct PassRecord {
  std::string name, technique, pass;
  bool ran = true;  ///< false: its inputs had not changed
  bool onHost =
      false;  ///< Pass::worksOnHost(): deviceMs is then by the host's clock, the device idle around it
  double hostMs = 0;        ///< until its last command was given to the device
  double deviceMs = 0;      ///< only in what PipelineExecutor::timedPasses() returns
  std::uint64_t bytes = 0;  ///< resources that it took from the pool
  Work work{};              ///< what it did; only with RenderOptions::countWork
};

struct FrameResult {
  std::map<std::string, ImageBuffer>
      outputs;  ///< rgb each (one channel for ambient occlusion); only when images were asked for
  std::map<std::string, Contributes> components;
  /// PipelineExecutor::indirectBounces() of the outputs that were wanted.
  std::map<std::string, int> indirectBounces;
  std::vector<PassRecord> passes;
  double frameMs = 0;          ///< whole frame, device idle before and after; with Timing::passes NaN
  double betweenPassesMs = 0;  ///< of the host, outside of the passes: what the framework itself costs
  /// The largest MemoryUse::bytes during the frame.
  std::uint64_t peakBytes = 0;
  /// With `checkReads`: "pass voxels, port grid: 96 of 4096 bytes differ from a run from scratch; ..."
  std::vector<std::string> readsFindings;
  std::vector<std::string> healthFindings;  ///< "pass gather, port diffuse: 3 NaN, first at pixel (12, 40)"
  /// With `health`: notes of passes, "pass gather: 1.1 % of the irradiance was ..."
  std::vector<std::string> notes;
};

/// One thing that a run leaves out. camera, scene: a trait of the camera or scene that no pass of the run
/// reads.
struct LeftOut {
  enum class Level { plugin, pass, variant, resource, time, camera, scene } level;
  std::string what, why;
  std::string pass;              ///< the pass that it belongs to; empty for plugins, variants and the pool
  std::uint64_t savedBytes = 0;  ///< 0 when not known
  double savedMs = 0;            ///< per frame; 0 when not measured
};
const char* name(LeftOut::Level level);

/// The parts of a pipeline that are left out on a scene. Variants, shared memory and times are known after
/// the first frame.
struct Explanation {
  std::vector<LeftOut> leftOut;
  std::size_t passesKept = 0, passesTotal = 0;
  std::size_t variantsPossible = 0, variantsCompiled = 0, variantsNeeded = 0;
  std::uint64_t poolBytes = 0;    ///< of all resources of the passes after the last frame
  std::uint64_t sharedBytes = 0;  ///< how much more they would need, did they not share memory
};

/// A pipeline bound to a scene and a device, ready to render frames.
class PipelineExecutor {
 public:
  /// Binds and prunes. Throws DiagnosticsError with all binding errors at once. Device, techniques and scene
  /// must outlive it.
  PipelineExecutor(gpu::Device& device, TechniqueSource& techniques, const Scene& scene,
                   const Pipeline& pipeline, const RenderOptions& options);
  ~PipelineExecutor();

  enum class Images { no, yes };
  /// What is timed: the whole frame, without instruments inside, or its passes, for timedPasses(). If the
  /// device's time stamps are trusted (DeviceInfo::timerQueriesTrusted), such a frame waits for nothing;
  /// otherwise it waits before and after every pass.
  enum class Timing { frame, passes };
  /// Renders the scene at `time`. Passes whose inputs did not change since the last call are not run again.
  FrameResult render(double time, int frameIndex = 0, Images images = Images::yes,
                     Timing timing = Timing::frame);
  /// The same for a given snapshot, such as that of the viewer's camera.
  FrameResult render(const SceneSnapshot& snapshot, int frameIndex = 0, Images images = Images::yes,
                     Timing timing = Timing::frame);
  /// The passes of every frame rendered with Timing::passes since the last call, in their order, with device
  /// times. Waits for the device.
  std::vector<std::vector<PassRecord>> timedPasses();
  /// Drops cached results and everything that passes keep between frames, so that the next frame runs every
  /// kept pass. Histories stay.
  void invalidate();
  /// The next frame finds no history and counts as the first.
  void emptyHistories();

  /// Sets the parameters, over the pipeline's defaults. Passes with unchanged parameters keep their results;
  /// images equal those of a new executor, to the bit. Histories are emptied. Throws DiagnosticsError like
  /// the constructor, and then changes nothing.
  void setParameters(const ParameterValues& values);
  /// Sets the seed. Passes that read it run again, with their readers, and histories are emptied.
  void setSeed(std::uint64_t seed);
  /// Sets RenderOptions::health.
  void setHealth(bool health);
  /// Whether a pass has read the seed in a frame so far. If none has, every seed gives the same bits.
  bool readsSeed() const;
  /// Sets the scene, such as the same text after an edit. It must outlive the executor; the previous one may
  /// be destroyed. Passes that read a difference run again, and histories are emptied. Error when it lacks
  /// the camera.
  void setScene(const Scene& scene);

  Explanation explain() const;
  MemoryUse memory() const;                             ///< at this moment
  const std::vector<std::string>& outputNames() const;  ///< kept and pruned; a pruned one renders as black
  shader::ShaderLibrary& shaders();
  /// Keeps an output of a pass alive after each render, and its pass with it; for exporters and tests. Error
  /// for an unknown name.
  void keepOutput(const std::string& pass, const std::string& port);
  /// The same for this output alone; outputs kept before are released.
  void keepOnly(const std::string& pass, const std::string& port);
  /// Whether resources that a frame does not use are freed at its end (the default) or stay for the next one:
  /// for timed frames that want different outputs in turn.
  void freeUnused(bool free);
  /// For each output, pruned ones included: the largest number of bounces that its pass or one before it
  /// models (Pass::indirectBounces()); 1 for an output without indirect light.
  std::map<std::string, int> indirectBounces() const;
  /// A pass of the pipeline with its parameters set, whether it runs or not. Error for an unknown name.
  const Pass& pass(const std::string& name) const;
  /// After the last render. Null when it was left out or given back. Error for an unknown name.
  const OutBase* output(const std::string& pass, const std::string& port) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Runs one pass alone on inputs that a test makes. A run finds no results of an earlier one, unless
/// accumulate() was called.
class PassHarness {
 public:
  PassHarness(gpu::Device& device, TechniqueSource& techniques, const std::string& technique,
              const std::string& pass, const Scene& scene, const SceneSnapshot& snapshot);
  ~PassHarness();
  Pass& pass();
  void setParameter(const std::string& name, double value);
  void setParameter(const std::string& name, const std::string& word);
  /// Gives an input a value made by the test.
  template <class Port>
  void setInput(const std::string& name, Port value) {
    auto source = std::make_unique<Out<Port>>(&holder(), name);
    *source = std::move(value);
    connectInput(name, std::move(source));
  }
  /// Of the outputs only this one is wanted, as in a pipeline that reads no other.
  void keepOnly(const std::string& output);
  /// Carries histories and kept results from run to run, as in frames in which nothing changes.
  void accumulate();
  void run(std::uint64_t seed = 1);
  template <class Port>
  const Port& output(const std::string& name) {
    return static_cast<const Out<Port>&>(outputNamed(name)).value();
  }
  PassContext& context();

 private:
  Pass& holder();
  void connectInput(const std::string& name, std::unique_ptr<OutBase> source);
  OutBase& outputNamed(const std::string& name);
  struct State;
  std::unique_ptr<State> state_;
};

/// The image of an output that was left out: its neutral element everywhere.
ImageBuffer neutralImage(int width, int height, Contributes component);

/// A texture's image as the framework stores images: row 0 on top.
ImageBuffer imageOf(const gpu::Texture& texture, int channels = 3);
/// The image of an output with a value: its first texture, in one channel for a fraction, with the flag for
/// radiance. Error for an output without a texture.
ImageBuffer imageOf(const OutBase& output);

}  // namespace lumivox
