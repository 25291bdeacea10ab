// Programs on demand: finds the variant in its pack, specialises and links it once, keeps it.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <map>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "lumivox/shader/pack.h"
#include "lumivox/shader/slots.h"
#include "lumivox/shader/work.h"

namespace lumivox::shader {

class CountingProgram;  // shader/counting.h

/// A linked program together with what it binds.
struct BoundProgram {
  std::unique_ptr<gpu::Program> program;
  const PackedProgram* packed;
  const PackedVariant* variant;
  std::shared_ptr<CountingProgram> counting;  ///< null unless ShaderLibrary::countWork() was called
};

class ShaderLibrary {
 public:
  explicit ShaderLibrary(gpu::Device& device);
  ~ShaderLibrary();

  /// Adds the pack of a technique. The same technique twice is an Error.
  void addPack(ShaderPack pack);

  /// Error for an unknown technique or program, for a combination that the constraints of the shader exclude,
  /// or from the driver. Asked for again, the same one; a loop over draws may ask each time.
  const BoundProgram& program(const ProgramName& name, VariantKey variant,
                              std::span<const gpu::SpecialisationValue> constants = {});

  /// Given in braces, or as any row of bindings that lies somewhere.
  using Bindings = std::span<const gpu::ResourceBinding>;
  using BindingList = std::initializer_list<gpu::ResourceBinding>;
  void dispatch(const BoundProgram& program, Bindings bindings, glm::uvec3 groups);
  void dispatch(const BoundProgram& program, BindingList bindings, glm::uvec3 groups) {
    dispatch(program, Bindings(bindings.begin(), bindings.end()), groups);
  }
  void dispatchIndirect(const BoundProgram& program, Bindings bindings, const gpu::Buffer& arguments,
                        std::uint64_t offsetBytes = 0);
  void dispatchIndirect(const BoundProgram& program, BindingList bindings, const gpu::Buffer& arguments,
                        std::uint64_t offsetBytes = 0) {
    dispatchIndirect(program, Bindings(bindings.begin(), bindings.end()), arguments, offsetBytes);
  }
  void drawIndexed(const BoundProgram& program, Bindings bindings, const gpu::Buffer& indices,
                   std::uint32_t firstIndex, std::uint32_t indexCount);
  void drawIndexed(const BoundProgram& program, BindingList bindings, const gpu::Buffer& indices,
                   std::uint32_t firstIndex, std::uint32_t indexCount) {
    drawIndexed(program, Bindings(bindings.begin(), bindings.end()), indices, firstIndex, indexCount);
  }
  void drawIndexed(const BoundProgram& program, const BindingSet& bindings, const gpu::Buffer& indices,
                   std::uint32_t firstIndex, std::uint32_t indexCount) {
    drawIndexed(program, Bindings(bindings), indices, firstIndex, indexCount);
  }
  void draw(const BoundProgram& program, const BindingSet& bindings, std::uint32_t vertexCount) {
    draw(program, Bindings(bindings), vertexCount);
  }
  void draw(const BoundProgram& program, Bindings bindings, std::uint32_t vertexCount);
  void draw(const BoundProgram& program, BindingList bindings, std::uint32_t vertexCount) {
    draw(program, Bindings(bindings.begin(), bindings.end()), vertexCount);
  }

  /// Checks that every binding which the variant uses is given, and drops those that this variant does not
  /// have: what a command does before it runs.
  static std::vector<gpu::ResourceBinding> select(const BoundProgram& program,
                                                  const std::vector<gpu::ResourceBinding>& bindings);

  /// For `lumivox shaders` and `explain`: variants that were asked for so far, per "technique/program".
  struct Usage {
    std::size_t possible = 0, compiled = 0;
    std::set<std::vector<int>> needed;
  };
  std::map<std::string, Usage> usage() const;
  const std::map<std::string, ShaderPack>& packs() const;
  gpu::Device& device();

  /// Makes every program count its work: the same results, several times slower. Precondition: no program was
  /// requested yet. AbsentError when the device takes its programs as GLSL.
  void countWork();
  /// The work of all programs since the last call, in operations by name.
  Work takeWork();

 private:
  static void selectInto(std::vector<gpu::ResourceBinding>& selected, const BoundProgram& program,
                         Bindings bindings);
  template <class Run>
  void run(const BoundProgram& program, Bindings bindings, Run&& run);
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lumivox::shader
