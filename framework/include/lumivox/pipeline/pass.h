// A pass, written by the author of a technique: a class whose members are its contract.
#pragma once

#include <algorithm>
#include <any>
#include <array>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lumivox/pipeline/contributes.h"
#include "lumivox/pipeline/parameter.h"
#include "lumivox/pipeline/ports.h"
#include "lumivox/scene/scene.h"
#include "lumivox/shader/library.h"

namespace lumivox {

class GpuScene;
class Pass;

/// Contents that a scene must have for an output (or a whole pass) to differ from its neutral element.
enum class Needs : std::uint32_t {
  nothing = 0,
  anyLight = 1u << 0,
  glossyMaterial = 1u << 1,
  environment = 1u << 2,
  medium = 1u << 3,
  emission = 1u << 4,
  textures = 1u << 5,
  movingGeometry = 1u << 6,
  triangles = 1u << 7,
  particles = 1u << 8,
  capturedFrame = 1u << 9
};
constexpr Needs operator|(Needs a, Needs b) {
  return static_cast<Needs>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}
/// The first need that the scene does not meet, in words ("a glossy material"), or empty.
std::string unmetNeed(Needs needs, const SceneTraits& traits);

/// Sources that a pass reads besides its inputs and parameters. A pass runs again only when one of these or
/// an input changed. materials: with their textures. lights: also the motion of emissive objects. camera:
/// also the image's size, but not the lens. lens: aperture and focus; passes without it render as through a
/// pinhole. partOfCamera: only what Pass::readsOfCamera() returns. time: also the frame's index. history:
/// results of earlier frames, by PassContext::history() and accumulated(); with accumulation
/// (RenderOptions::accumulate) such a pass runs in every frame. capture: the frames of captures that belong
/// to the time; it changes with the frame, not with the clock.
enum class Reads : std::uint32_t {
  nothing = 0,
  geometry = 1u << 0,
  materials = 1u << 1,
  lights = 1u << 2,
  camera = 1u << 3,
  time = 1u << 4,
  partOfCamera = 1u << 5,
  environment = 1u << 6,
  media = 1u << 7,
  history = 1u << 8,
  lens = 1u << 9,
  capture = 1u << 10
};
constexpr Reads operator|(Reads a, Reads b) {
  return static_cast<Reads>(static_cast<std::uint32_t>(a) | static_cast<std::uint32_t>(b));
}
constexpr Reads operator&(Reads a, Reads b) {
  return static_cast<Reads>(static_cast<std::uint32_t>(a) & static_cast<std::uint32_t>(b));
}
constexpr Reads operator~(Reads a) {
  return static_cast<Reads>(~static_cast<std::uint32_t>(a));
}
constexpr bool reads(Reads set, Reads one) {
  return (set & one) != Reads::nothing;
}

/// The levels of a grid with mips that an output fills, or that an input reads.
enum class Levels { unspecified, finest, all };

/// What an input expects of the connected output, beyond its kind. Any other output gives a warning, since
/// the light would be wrong.
struct Expects {
  std::optional<Contributes> component;  ///< of the image, which the output holds; `nothing`: none of them
  Levels levels = Levels::unspecified;   ///< all: each must be filled

  Expects() = default;
  Expects(Contributes held)
      : component(held) {}                    // NOLINT: a member of a pass says `Contributes::direct` alone
  Expects(Levels filled) : levels(filled) {}  // NOLINT: or `Levels::all`
};

/// Members of a pass register themselves with it, in the order of declaration.
class PortBase {
 public:
  PortBase(std::string name, const PortKind& kind, std::string meaning);
  virtual ~PortBase() = default;
  PortBase(const PortBase&) = delete;
  PortBase& operator=(const PortBase&) = delete;
  const std::string& name() const { return name_; }
  const PortKind& kind() const { return *kind_; }
  const std::string& meaning() const { return meaning_; }

 private:
  std::string name_, meaning_;
  const PortKind* kind_;
};

class OutBase : public PortBase {
 public:
  OutBase(Pass* pass, std::string name, const PortKind& kind, Contributes contributes, Needs needs,
          std::string meaning, Levels levels);
  Contributes contributes() const { return contributes_; }
  Levels levels() const { return levels_; }
  Needs needs() const { return needs_; }
  /// Whether this run uses the output: false when it was pruned. A pass computes only wanted outputs.
  bool wanted() const { return wanted_; }
  virtual bool hasValue() const = 0;
  virtual void reset() = 0;
  /// Contents of the value; none without a value.
  virtual PortContents contents() const = 0;
  /// The textures among contents().
  std::vector<gpu::TextureRef> textures() const;

 private:
  friend class PipelineExecutor;
  friend class PassHarness;
  Contributes contributes_;
  Needs needs_;
  Levels levels_;
  bool wanted_ = true;
};

/// An output. run() assigns it whenever it is wanted. After its last reader its resources return to the
/// executor's pool, unless a later frame may need them.
template <class Port>
class Out : public OutBase {
 public:
  Out(Pass* pass, std::string name, Contributes contributes = Contributes::nothing,
      Needs needs = Needs::nothing, std::string meaning = {}, Levels levels = Levels::unspecified)
      : OutBase(pass, std::move(name), portKind<Port>(), contributes, needs, std::move(meaning), levels) {}
  Out(Pass* pass, std::string name, std::string meaning, Levels levels = Levels::unspecified)
      : Out(pass, std::move(name), Contributes::nothing, Needs::nothing, std::move(meaning), levels) {}
  Out& operator=(Port value) {
    value_ = std::move(value);
    return *this;
  }
  const Port& value() const { return *value_; }
  const Port* operator->() const { return &*value_; }
  explicit operator bool() const { return hasValue(); }
  bool hasValue() const override { return value_.has_value(); }
  void reset() override { value_.reset(); }
  PortContents contents() const override {
    PortContents result(kind());
    if (value_) PortTraits<Port>::contents(*value_, result);
    return result;
  }

 private:
  std::optional<Port> value_;
};

/// history: optional, and the value of the connected output (of this pass, a later or an earlier one) at the
/// end of the previous frame. Absent in the first frame, after histories were emptied, and in runs that do
/// not accumulate.
enum class Presence { required, optional, history };

class InBase : public PortBase {
 public:
  InBase(Pass* pass, std::string name, const PortKind& kind, Presence presence, std::string meaning,
         Needs needs, Expects expects);
  Presence presence() const { return presence_; }
  const Expects& expects() const { return expects_; }
  /// Contents that the scene must have for this input to be read. Without them the input does not keep its
  /// source alive.
  Needs needs() const { return needs_; }
  /// False when nothing is connected or the connected output was pruned: the pass then uses the variant
  /// without this input.
  bool present() const {
    return presence_ == Presence::history ? holds() : source_ != nullptr && source_->hasValue();
  }
  explicit operator bool() const { return present(); }
  /// Whether outputs of a kind can be connected.
  virtual bool takes(const PortKind& kind) const { return kind.isSameType(this->kind()); }
  /// Connects or disconnects; the input must take the kind (checked by the graph with a message; asserted
  /// here).
  void connect(const OutBase* source);
  /// For a history: keeps the source's present value for the next frame; or forgets the kept value.
  virtual void hold() = 0;
  virtual void forget() = 0;

 protected:
  virtual bool holds() const = 0;
  const OutBase* source_ = nullptr;

 private:
  Presence presence_;
  Needs needs_;
  Expects expects_;
};

template <class Port>
class In : public InBase {
 public:
  In(Pass* pass, std::string name, std::string meaning = {}, Expects expects = {})
      : InBase(pass, std::move(name), portKind<Port>(), Presence::required, std::move(meaning),
               Needs::nothing, expects) {}
  /// `needs` is for inputs that are not required: what the scene must have for the input to be read.
  In(Pass* pass, std::string name, Presence presence, std::string meaning = {}, Needs needs = Needs::nothing,
     Expects expects = {})
      : InBase(pass, std::move(name), portKind<Port>(), presence, std::move(meaning), needs, expects) {}
  const Port& operator*() const {
    return presence() == Presence::history ? *held_ : static_cast<const Out<Port>*>(source_)->value();
  }
  const Port* operator->() const { return &**this; }
  void hold() override {
    held_.reset();
    if (source_ != nullptr && source_->hasValue()) held_ = static_cast<const Out<Port>*>(source_)->value();
  }
  void forget() override { held_.reset(); }

 protected:
  bool holds() const override { return held_.has_value(); }

 private:
  std::optional<Port> held_;  ///< with Presence::history
};

/// An input for outputs of any kind with fields (PortKind::fields), a technique's own included. The pass sees
/// the contents that an exporter sees. It is read in the frame that made it.
class InVoxels : public InBase {
 public:
  InVoxels(Pass* pass, std::string name, std::string meaning = {})
      : InBase(pass, std::move(name), anyVoxels(), Presence::required, std::move(meaning), Needs::nothing,
               {}) {}
  bool takes(const PortKind& kind) const override { return !kind.fields.empty(); }
  PortContents contents() const { return source_->contents(); }
  void hold() override {}
  void forget() override {}
  /// The kind in texts and messages: no output is of this kind.
  static const PortKind& anyVoxels();

 protected:
  bool holds() const override { return false; }
};

/// A resource that a pass carries from frame to frame.
template <class Resource>
struct History {
  Resource previous;  ///< as the pass left `current` in the frame before; null where histories are empty
  Resource current;   ///< what the next frame finds as `previous`; its contents are undefined
};

/// Everything that a pass may use while it runs.
class PassContext {
 public:
  virtual ~PassContext() = default;
  virtual gpu::Device& device() = 0;
  virtual shader::ShaderLibrary& shaders() = 0;
  virtual GpuScene& scene() = 0;
  virtual const Scene& sceneDescription() const = 0;
  virtual const SceneSnapshot& snapshot() const = 0;
  /// Traits of the scene; all of them with --keep-everything. Choose variants by this, never by looking at
  /// the scene.
  virtual const SceneTraits& traits() const = 0;
  /// True with --keep-everything: every draw uses the fullest variant, with neutral textures.
  virtual bool keepsEverything() const = 0;
  virtual int frameIndex() const = 0;
  virtual std::uint64_t seed() const = 0;

  /// Resources from the pool: contents are undefined. They return to the pool when the last reference goes.
  virtual gpu::TextureRef texture(const gpu::TextureDescription& description, const std::string& label) = 0;
  virtual gpu::BufferRef buffer(std::uint64_t sizeBytes, const std::string& label) = 0;
  /// Checks a count that the device finds, without a wait: one word of a buffer, read after the whole frame.
  /// `check` returns false if the pass had allocated too little room for that count, and records the room
  /// that it needs; the frame is then rendered again from the start, and nothing of the failed frame is
  /// delivered. It may throw an Error and warn() through the context that it is given.
  using CountCheck = std::function<bool(PassContext& frame, std::uint32_t count)>;
  virtual void checkAfterFrame(gpu::BufferRef counts, std::uint64_t offsetBytes, CountCheck check) = 0;
  /// A warning to the user, once per run, with the pass's name.
  virtual void warn(const std::string& text) = 0;
  /// A result that is kept while it stays valid: the result of make(), or that of an earlier frame with the
  /// same `what` and `key`. The key, compared by ==, holds everything that the result depends on and that
  /// changes while the pass lives, such as the place of a grid. Parameters, seed and contents of the scene
  /// need not be in it: their change, and PipelineExecutor::invalidate(), drop all results. With
  /// --keep-everything nothing is kept. A result that a run of the pass does not request is released.
  /// explain() reports what was reused.
  template <class Key, class Make>
  const auto& kept(const std::string& what, const Key& key, Make&& make) {
    using Value = std::decay_t<std::invoke_result_t<Make&>>;
    Kept& entry = keptEntry(what);
    const Key* const before = std::any_cast<Key>(&entry.key);
    if (before != nullptr && *before == key) {
      tellReused(what);
      return std::any_cast<const Value&>(entry.value);
    }
    entry = {};  // before the next one is made: the pool may give back the same memory
    entry.value = Value(make());
    entry.key = key;
    return std::any_cast<const Value&>(entry.value);
  }
  /// Resources that stay for the next frame; needs Reads::history. Both resources are separate, so that a
  /// frame that is rendered again finds `previous` unchanged. `previous` is null in the first frame, after a
  /// frame without a request for this label and shape, after a change of the image's size, a parameter, the
  /// seed or the pipeline, and in runs that do not accumulate.
  virtual History<gpu::TextureRef> history(const gpu::TextureDescription& description,
                                           const std::string& label) = 0;
  virtual History<gpu::BufferRef> history(std::uint64_t sizeBytes, const std::string& label) = 0;
  /// Number of frames in a row in which nothing changed that this pass or any source of it depends on: 0 in
  /// the first frame and in runs that do not accumulate. Needs Reads::history.
  virtual int accumulated() const = 0;
  /// True with RenderOptions::health: a pass may then spend time on measuring itself. It reports with note(),
  /// a sentence that follows the pass's name: "1.1 % of the irradiance was ...".
  virtual bool inspects() const = 0;
  virtual void note(const std::string& text) = 0;

  const shader::BoundProgram& program(const shader::ProgramName& name, shader::VariantKey variant = {},
                                      std::span<const gpu::SpecialisationValue> constants = {}) {
    return shaders().program(name, variant, constants);
  }
  /// The program of a generated Variant, with its generated Constants.
  template <class Variant>
  requires requires { Variant::kOf; }
  const shader::BoundProgram& program(const Variant& variant) {
    return shaders().program(Variant::kOf, variant.key());
  }
  template <class Variant, class Constants>
  requires requires { Variant::kOf; }
  const shader::BoundProgram& program(const Variant& variant, const Constants& constants) {
    return shaders().program(Variant::kOf, variant.key(), constants.values());
  }
  /// One invocation per item along each axis, in work groups of the program's size; a barrier follows.
  void dispatch(const shader::BoundProgram& program, const shader::BindingSet& bindings, glm::ivec3 items);
  /// The same for the items of a list, which may be longer than a row of work groups: the shader counts with
  /// listIndex() of shaders/common/list.glsl.
  void dispatchList(const shader::BoundProgram& program, const shader::BindingSet& bindings,
                    std::uint64_t items);
  /// Work groups as the device has counted them: three words of `arguments`; a barrier follows.
  void dispatchIndirect(const shader::BoundProgram& program, const shader::BindingSet& bindings,
                        const gpu::Buffer& arguments, std::uint64_t offsetBytes = 0);

  /// A d2 texture of the image's size. The default, 32-bit floats, holds positions and radiances of any
  /// scale.
  gpu::TextureRef image(const std::string& label, gpu::Format format = gpu::Format::rgba32f);
  gpu::TextureRef volume(const glm::ivec3& size, gpu::Format format, const std::string& label,
                         int levels = 1);
  /// The same with zeros.
  gpu::TextureRef emptyVolume(const glm::ivec3& size, gpu::Format format, const std::string& label);
  /// Room for so many elements of a storage block that ends with an array of open length, and for one at
  /// least.
  gpu::BufferRef elements(const shader::StorageSlot& block, std::uint64_t count, const std::string& label);
  /// The same with zeros.
  gpu::BufferRef emptyElements(const shader::StorageSlot& block, std::uint64_t count,
                               const std::string& label);
  /// A buffer with these values: with one of zeros where there are none.
  template <class Range>
  gpu::BufferRef uploaded(const Range& values, const std::string& label) {
    const auto bytes = std::as_bytes(std::span(values));
    gpu::BufferRef result = buffer(std::max(bytes.size(), sizeof(*std::data(values))), label);
    if (bytes.empty()) result->clear();
    result->upload(bytes);
    return result;
  }

  /// An entry of kept() under one name.
  struct Kept {
    std::any key, value;
  };

 protected:
  /// Of the pass that runs; empty where nothing of an earlier frame may be used.
  virtual Kept& keptEntry(const std::string& what) = 0;
  virtual void tellReused(const std::string& what) = 0;
};

class Pass {
 public:
  virtual ~Pass() = default;
  virtual void run(PassContext& frame) = 0;
  /// Sources read besides the inputs.
  virtual Reads readsFrom() const { return Reads::nothing; }
  /// With Reads::partOfCamera: the values that it derives from the camera, such as the place of its grids.
  /// While these stay the same, a moved camera does not make the pass run again.
  virtual std::vector<float> readsOfCamera(const SceneSnapshot&) const { return {}; }
  /// False for an input that the present parameters make useless. The input then does not keep its source
  /// alive, and may be absent even if it is required. Its value must not change a bit of the outputs.
  virtual bool uses(const InBase&) const { return true; }
  /// Number of indirect bounces that the pass's indirect outputs model. It decides the reference for their
  /// bias.
  virtual int indirectBounces() const { return 1; }
  /// True for a pass whose work is the host's: it is timed by the host's clock, with the device idle before
  /// and after.
  virtual bool worksOnHost() const { return false; }
  /// Contents that the scene must have for the pass as a whole.
  virtual Needs needs() const { return Needs::nothing; }
  /// Contradictions between parameters, in words; empty when there are none.
  virtual std::string checkParameters() const { return {}; }

  const std::vector<InBase*>& inputs() const { return inputs_; }
  const std::vector<OutBase*>& outputs() const { return outputs_; }
  const std::vector<ParamBase*>& parameters() const { return parameters_; }

  /// Gives every parameter that no text states its published value (`as_published on`) or its default
  /// (`off`). Returns in words what contradicts `on`; empty otherwise. The framework calls it once parameters
  /// are set.
  std::string applyPublished();

 private:
  friend class OutBase;
  friend class InBase;
  friend class ParamBase;
  friend class PublishedForm;
  PublishedForm* publishedForm_ = nullptr;  ///< the last of `parameters_`
  std::unique_ptr<PublishedForm> ownPublishedForm_;
  std::vector<InBase*> inputs_;
  std::vector<OutBase*> outputs_;
  std::vector<ParamBase*> parameters_;
};

}  // namespace lumivox
