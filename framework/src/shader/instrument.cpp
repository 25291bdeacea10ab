#include "shader/instrument.h"

#include <fmt/format.h>
#include <spirv/unified1/GLSL.std.450.h>

#include <algorithm>
#include <optional>
#include <set>
#define SPV_ENABLE_UTILITY_CODE  // which instructions have results
#include <spirv/unified1/spirv.hpp>

#include "lumivox/base/error.h"

namespace lumivox::shader {
namespace {

using Id = std::uint32_t;
using Operands = std::span<const std::uint32_t>;

constexpr std::size_t kHeaderWords = 5;
constexpr std::size_t kBoundWord = 3;

/// Calls `found(operation, operands, first word)` for every instruction.
template <class Found>
void forEachInstruction(std::span<const std::uint32_t> words, Found&& found) {
  for (std::size_t at = kHeaderWords; at < words.size();) {
    const std::uint32_t length = words[at] >> 16;
    if (length == 0 || at + length > words.size())
      throw Error(fmt::format("SPIR-V word {}: an instruction of {} words does not fit", at, length));
    found(static_cast<spv::Op>(words[at] & 0xffffu), Operands(&words[at] + 1, length - 1), at);
    at += length;
  }
}

struct Type {
  spv::Op operation = spv::OpTypeVoid;
  std::vector<std::uint32_t> operands;  ///< without the result
};

/// The types, variables and decorations that determine the cost of an instruction.
class Module {
 public:
  void learn(spv::Op operation, Operands w) {
    if (operation >= spv::OpTypeVoid && operation <= spv::OpTypeForwardPointer) {
      if (!w.empty()) types_[w[0]] = {operation, {w.begin() + 1, w.end()}};
      return;
    }
    switch (operation) {
      case spv::OpExtInstImport:
        library_ = w[0];
        break;
      case spv::OpEntryPoint:
        entryFunction = w[1];
        break;
      case spv::OpExecutionMode:
        if (w[1] == spv::ExecutionModeLocalSize) groupSize = 1.0 * w[2] * w[3] * w[4];
        break;
      case spv::OpDecorate:
        if (w[1] == spv::DecorationBinding) bindings_[w[0]] = w[2];
        // Built-ins that are uniform over a work group.
        if (w[1] == spv::DecorationBuiltIn &&
            (w[2] == spv::BuiltInWorkgroupId || w[2] == spv::BuiltInNumWorkgroups))
          ofGroup_.insert(w[0]);
        if (w[1] == spv::DecorationBufferBlock) storageBlocks_[w[0]] = true;
        break;
      case spv::OpConstant:
        constants_[w[1]] = w[2];
        break;
      default:
        break;
    }
    bool hasResult = false, hasType = false;
    spv::HasResultAndType(operation, &hasResult, &hasType);
    if (hasResult && hasType && w.size() >= 2) typeOf_[w[1]] = w[0];
    // Traces values to the variable that they come from: its parts, or a texture loaded from it.
    switch (operation) {
      case spv::OpVariable:
        variableOf_[w[1]] = w[1];
        break;
      case spv::OpAccessChain:
      case spv::OpInBoundsAccessChain:
      case spv::OpLoad:
      case spv::OpImage:
      case spv::OpCopyObject:
      case spv::OpImageTexelPointer:
        if (const auto base = variableOf_.find(w[2]); base != variableOf_.end())
          variableOf_[w[1]] = base->second;
        break;
      default:
        break;
    }
  }

  /// Finds values that can differ between neighbouring invocations: inputs, results of atomics, and values
  /// computed from them. Repeat it until it returns false, since loops pass values back. It misses values
  /// that differ only because neighbours took other branches.
  bool spread(spv::Op operation, Operands w);

  BlockWork& count(spv::Op operation, Operands w, BlockWork& block) const;
  Id entryFunction = 0;
  double groupSize = 1.0;
  /// The type of 32-bit unsigned integers, if the module has one: SPIR-V allows a type to be declared only
  /// once.
  Id unsignedType() const {
    for (const auto& [id, type] : types_)
      if (type.operation == spv::OpTypeInt && type.operands == std::vector<std::uint32_t>{32, 0}) return id;
    return 0;
  }

 private:
  const Type& type(Id id) const {
    static const Type kUnknown;
    const auto found = types_.find(id);
    return found == types_.end() ? kUnknown : found->second;
  }
  const Type& typeOfValue(Id value) const {
    const auto found = typeOf_.find(value);
    return type(found == typeOf_.end() ? 0 : found->second);
  }
  double components(const Type& t) const {
    return t.operation == spv::OpTypeVector ? static_cast<double>(t.operands[1]) : 1.0;
  }
  double bytes(Id id) const;
  std::optional<std::uint32_t> bindingOf(Id value) const {
    const auto variable = variableOf_.find(value);
    if (variable == variableOf_.end()) return std::nullopt;
    const auto binding = bindings_.find(variable->second);
    return binding == bindings_.end() ? std::nullopt : std::optional(binding->second);
  }
  /// The storage class of a pointer; Function, which costs nothing, for an unknown one.
  spv::StorageClass storage(Id pointer) const {
    const Type& t = typeOfValue(pointer);
    return t.operation == spv::OpTypePointer ? static_cast<spv::StorageClass>(t.operands[0])
                                             : spv::StorageClassFunction;
  }
  bool isStorageBlock(Id pointer) const {
    const auto variable = variableOf_.find(pointer);
    if (variable == variableOf_.end()) return false;
    const Type& t = typeOfValue(variable->second);
    return t.operation == spv::OpTypePointer && storageBlocks_.count(t.operands[1]) != 0;
  }
  void countAccess(Id pointer, double sizeBytes, const std::string& bufferName, BlockWork& block) const;
  bool differs(Id value) const { return divergent_.count(value) != 0; }
  void countTexture(TextureAccess::Kind kind, Id image, BlockWork& block) const {
    if (const auto binding = bindingOf(image)) block.access[{kind, *binding}] += 1.0;
  }
  void countFunction(Operands w, BlockWork& block) const;

  Id library_ = 0;
  std::map<Id, Type> types_;
  std::map<Id, Id> typeOf_, variableOf_;
  std::map<Id, std::uint32_t> bindings_, constants_;
  std::map<Id, bool> storageBlocks_;
  std::set<Id> ofGroup_, divergent_;
};

bool Module::spread(spv::Op operation, Operands w) {
  bool hasResult = false, hasType = false;
  spv::HasResultAndType(operation, &hasResult, &hasType);
  if (operation == spv::OpStore) {
    // A variable of the invocation returns the values stored in it.
    const auto variable = variableOf_.find(w[0]);
    if (variable == variableOf_.end() || storage(w[0]) == spv::StorageClassUniform) return false;
    return (differs(w[1]) || differs(w[0])) && divergent_.insert(variable->second).second;
  }
  if (!hasResult || !hasType || w.size() < 3) return false;
  bool is = operation >= spv::OpAtomicLoad && operation <= spv::OpAtomicXor;
  if (operation == spv::OpLoad) {
    const auto variable = variableOf_.find(w[2]);
    is = differs(w[2]) || (variable != variableOf_.end() &&
                           (differs(variable->second) || (storage(w[2]) == spv::StorageClassInput &&
                                                          ofGroup_.count(variable->second) == 0)));
  } else {
    // Literal numbers among the operands are no values.
    const std::size_t first = operation == spv::OpExtInst ? 4 : 2;
    const std::size_t end = operation == spv::OpCompositeExtract ? 3
                            : operation == spv::OpCompositeInsert || operation == spv::OpVectorShuffle
                                ? 4
                                : w.size();
    for (std::size_t i = first; i < std::min(end, w.size()); ++i) is = is || differs(w[i]);
  }
  return is && divergent_.insert(w[1]).second;
}

/// Size of a value in a buffer, without padding; a runtime array counts as one element.
double Module::bytes(Id id) const {
  const Type& t = type(id);
  switch (t.operation) {
    case spv::OpTypeBool:
      return 4.0;
    case spv::OpTypeInt:
    case spv::OpTypeFloat:
      return static_cast<double>(t.operands[0]) / 8.0;
    case spv::OpTypeVector:
    case spv::OpTypeMatrix:
      return bytes(t.operands[0]) * static_cast<double>(t.operands[1]);
    case spv::OpTypeArray: {
      const auto length = constants_.find(t.operands[1]);
      return bytes(t.operands[0]) * (length == constants_.end() ? 1.0 : static_cast<double>(length->second));
    }
    case spv::OpTypeRuntimeArray:
      return bytes(t.operands[0]);
    case spv::OpTypeStruct: {
      double sum = 0.0;
      for (const Id member : t.operands) sum += bytes(member);
      return sum;
    }
    default:
      return 0.0;
  }
}

void Module::countAccess(Id pointer, double sizeBytes, const std::string& bufferName,
                         BlockWork& block) const {
  const spv::StorageClass place = storage(pointer);
  if (place == spv::StorageClassWorkgroup) block.work["shared_accesses"] += 1.0;
  if (place == spv::StorageClassUniform && isStorageBlock(pointer)) block.work[bufferName] += sizeBytes;
}

/// Counts a function of GLSL.std.450: one instruction of the arithmetic units, or a series or table.
void Module::countFunction(Operands w, BlockWork& block) const {
  if (w[2] != library_) return;
  const double n = components(type(w[0]));
  const auto operand = [&](std::size_t i) { return components(typeOfValue(w[4 + i])); };
  switch (w[3]) {
    case GLSLstd450Exp:
    case GLSLstd450Exp2:
    case GLSLstd450Log:
    case GLSLstd450Log2:
    case GLSLstd450Sinh:
    case GLSLstd450Cosh:
    case GLSLstd450Tanh:
      block.work["exponentials"] += n;
      break;
    case GLSLstd450Pow:  // exp2(y log2(x))
      block.work["exponentials"] += 2.0 * n;
      block.work["float_operations"] += n;
      break;
    case GLSLstd450Sin:
    case GLSLstd450Cos:
    case GLSLstd450Tan:
    case GLSLstd450Asin:
    case GLSLstd450Acos:
    case GLSLstd450Atan:
    case GLSLstd450Atan2:
      block.work["sines"] += n;
      break;
    case GLSLstd450Sqrt:
    case GLSLstd450InverseSqrt:
      block.work["inverse_square_roots"] += n;
      break;
    case GLSLstd450Length:
      block.work["inverse_square_roots"] += 1.0;
      block.work["float_operations"] += 2.0 * operand(0) - 1.0;
      break;
    case GLSLstd450Distance:
      block.work["inverse_square_roots"] += 1.0;
      block.work["float_operations"] += 3.0 * operand(0) - 1.0;
      break;
    case GLSLstd450Normalize:
      block.work["inverse_square_roots"] += 1.0;
      block.work["float_operations"] += 3.0 * n - 1.0;
      break;
    case GLSLstd450Cross:
      block.work["float_operations"] += 9.0;
      break;
    case GLSLstd450Fma:
    case GLSLstd450FClamp:
      block.work["float_operations"] += 2.0 * n;
      break;
    case GLSLstd450FMix:
      block.work["float_operations"] += 3.0 * n;
      break;
    case GLSLstd450SmoothStep:
      block.work["float_operations"] += 9.0 * n;
      break;
    case GLSLstd450Reflect:  // I - 2 dot(N, I) N
      block.work["float_operations"] += 4.0 * n;
      break;
    case GLSLstd450SAbs:
    case GLSLstd450SSign:
    case GLSLstd450UMin:
    case GLSLstd450SMin:
    case GLSLstd450UMax:
    case GLSLstd450SMax:
    case GLSLstd450FindILsb:
    case GLSLstd450FindSMsb:
    case GLSLstd450FindUMsb:
      block.work["integer_operations"] += n;
      break;
    case GLSLstd450UClamp:
    case GLSLstd450SClamp:
      block.work["integer_operations"] += 2.0 * n;
      break;
    default:
      block.work["float_operations"] += n;
  }
}

BlockWork& Module::count(spv::Op operation, Operands w, BlockWork& block) const {
  if (operation >= spv::OpImageSampleImplicitLod && operation <= spv::OpImageSampleProjDrefExplicitLod) {
    countTexture(TextureAccess::Kind::sample, w[2], block);
    return block;
  }
  if (operation >= spv::OpAtomicLoad && operation <= spv::OpAtomicXor) {
    const Id pointer = operation == spv::OpAtomicStore ? w[0] : w[2];
    const spv::StorageClass place = storage(pointer);
    block.work[place == spv::StorageClassImage       ? "image_atomics"
               : place == spv::StorageClassWorkgroup ? "shared_atomics"
                                                     : "buffer_atomics"] += 1.0;
    return block;
  }
  switch (operation) {
    case spv::OpImageGather:
    case spv::OpImageDrefGather:
      countTexture(TextureAccess::Kind::sample, w[2], block);
      return block;
    case spv::OpImageFetch:
      countTexture(TextureAccess::Kind::fetch, w[2], block);
      return block;
    case spv::OpImageRead:
      countTexture(TextureAccess::Kind::read, w[2], block);
      return block;
    case spv::OpImageWrite:
      countTexture(TextureAccess::Kind::write, w[0], block);
      return block;
    case spv::OpLoad:
      countAccess(w[2], bytes(w[0]), differs(w[2]) ? "buffer_reads" : "buffer_reads_uniform", block);
      return block;
    case spv::OpStore: {
      const auto stored = typeOf_.find(w[1]);
      countAccess(w[0], stored == typeOf_.end() ? 0.0 : bytes(stored->second), "buffer_writes", block);
      return block;
    }
    case spv::OpExtInst:
      countFunction(w, block);
      return block;
    case spv::OpDot:
      block.work["float_operations"] += 2.0 * components(typeOfValue(w[2])) - 1.0;
      return block;
    default:
      break;
  }
  // Arithmetic instructions have consecutive codes, from conversions to comparisons and bit operations
  // (SPIR-V, Sec. 3.32.11 to 3.32.15).
  if (operation < spv::OpConvertFToU || operation > spv::OpBitCount || operation == spv::OpBitcast)
    return block;
  const Type& result = type(w[0]);
  const Type& scalar = result.operation == spv::OpTypeVector ? type(result.operands[0]) : result;
  const Type& argument = typeOfValue(w[2]);
  const Type& argumentScalar =
      argument.operation == spv::OpTypeVector ? type(argument.operands[0]) : argument;
  const bool isFloat = scalar.operation == spv::OpTypeFloat ||
                       (scalar.operation == spv::OpTypeBool && argumentScalar.operation == spv::OpTypeFloat);
  block.work[isFloat ? "float_operations" : "integer_operations"] += components(result);
  return block;
}

void emit(std::vector<std::uint32_t>& words, spv::Op operation,
          std::initializer_list<std::uint32_t> operands) {
  words.push_back(static_cast<std::uint32_t>((operands.size() + 1) << 16 | operation));
  words.insert(words.end(), operands);
}

/// The declarations that counting needs, and the code of one count.
class Counter {
 public:
  Counter(Id& bound, Id unsignedType, std::uint32_t binding) : bound_(bound) {
    uint_ = unsignedType != 0 ? unsignedType : bound_++;
    const Id array = bound_++, block = bound_++, blockPointer = bound_++;
    uintPointer_ = bound_++;
    variable_ = bound_++;
    boolean_ = bound_++;
    emit(decorations, spv::OpDecorate, {array, spv::DecorationArrayStride, 4});
    emit(decorations, spv::OpDecorate, {block, spv::DecorationBufferBlock});
    emit(decorations, spv::OpMemberDecorate, {block, 0, spv::DecorationOffset, 0});
    emit(decorations, spv::OpDecorate, {variable_, spv::DecorationDescriptorSet, 0});
    emit(decorations, spv::OpDecorate, {variable_, spv::DecorationBinding, binding});
    if (unsignedType == 0) emit(declarations, spv::OpTypeInt, {uint_, 32, 0});
    emit(declarations, spv::OpTypeRuntimeArray, {array, uint_});
    emit(declarations, spv::OpTypeStruct, {block, array});
    emit(declarations, spv::OpTypePointer, {blockPointer, spv::StorageClassUniform, block});
    emit(declarations, spv::OpTypePointer, {uintPointer_, spv::StorageClassUniform, uint_});
    emit(declarations, spv::OpVariable, {blockPointer, variable_, spv::StorageClassUniform});
    zero_ = constant(0);
    one_ = constant(1);
    most_ = constant(~0u);
    device_ = constant(spv::ScopeDevice);
  }
  /// Uses the module's own Boolean type: SPIR-V allows only one declaration.
  void useBoolean(Id type) { boolean_ = type; }
  void declareBoolean() { emit(declarations, spv::OpTypeBool, {boolean_}); }

  /// Emits code that adds one to a counter of two words, with the carry from the low word to the high one.
  void count(std::vector<std::uint32_t>& code, std::uint32_t word) {
    const Id low = constant(word), high = constant(word + 1);
    const Id lowPointer = bound_++, highPointer = bound_++, before = bound_++, wraps = bound_++,
             carry = bound_++, ignored = bound_++;
    emit(code, spv::OpAccessChain, {uintPointer_, lowPointer, variable_, zero_, low});
    emit(code, spv::OpAtomicIAdd, {uint_, before, lowPointer, device_, zero_, one_});
    emit(code, spv::OpIEqual, {boolean_, wraps, before, most_});
    emit(code, spv::OpSelect, {uint_, carry, wraps, one_, zero_});
    emit(code, spv::OpAccessChain, {uintPointer_, highPointer, variable_, zero_, high});
    emit(code, spv::OpAtomicIAdd, {uint_, ignored, highPointer, device_, zero_, carry});
  }

  std::vector<std::uint32_t> decorations, declarations;

 private:
  Id constant(std::uint32_t value) {
    const Id id = bound_++;
    emit(declarations, spv::OpConstant, {uint_, id, value});
    return id;
  }

  Id& bound_;
  Id uint_ = 0, uintPointer_ = 0, variable_ = 0, boolean_ = 0, zero_ = 0, one_ = 0, most_ = 0, device_ = 0;
};

}  // namespace

CountingCode instrument(std::span<const std::uint32_t> spirv, std::uint32_t binding,
                        std::uint32_t firstCounter) {
  constexpr std::uint32_t kVersion14 = 0x00010400;
  if (spirv.size() < kHeaderWords || spirv[0] != spv::MagicNumber)
    throw Error("the code to be counted is not SPIR-V");
  if (spirv[1] >= kVersion14)
    throw Error(fmt::format("SPIR-V {}.{} cannot be counted; expected a version before 1.4", spirv[1] >> 16,
                            spirv[1] >> 8 & 0xffu));
  Module module;
  Id boolean = 0;
  forEachInstruction(spirv, [&](spv::Op operation, Operands w, std::size_t) {
    module.learn(operation, w);
    if (operation == spv::OpTypeBool) boolean = w[0];
  });

  for (bool more = true; more;) {
    more = false;
    forEachInstruction(spirv, [&](spv::Op operation, Operands w, std::size_t) {
      more = module.spread(operation, w) || more;
    });
  }

  CountingCode result;
  result.groupSize = module.groupSize;
  Id bound = spirv[kBoundWord];
  Counter counter(bound, module.unsignedType(), binding);
  if (boolean != 0)
    counter.useBoolean(boolean);
  else
    counter.declareBoolean();

  std::vector<std::uint32_t> before, types, functions;  // up to the first type; up to the first function
  bool inTypes = false, inFunctions = false, opens = false, entry = false;
  forEachInstruction(spirv, [&](spv::Op operation, Operands w, std::size_t at) {
    inTypes = inTypes || (operation >= spv::OpTypeVoid && operation <= spv::OpTypeForwardPointer);
    inFunctions = inFunctions || operation == spv::OpFunction;
    std::vector<std::uint32_t>& into = inFunctions ? functions : inTypes ? types : before;
    // The counting code follows the instructions that must come first in a block.
    const bool first = operation == spv::OpLabel || operation == spv::OpPhi || operation == spv::OpVariable ||
                       operation == spv::OpLine || operation == spv::OpNoLine;
    if (opens && !first) {
      counter.count(into, firstCounter + 2 * static_cast<std::uint32_t>(result.blocks.size() - 1));
      opens = false;
    }
    if (operation == spv::OpFunction) entry = w[1] == module.entryFunction;
    if (operation == spv::OpLabel) {
      if (entry) result.entry = result.blocks.size();
      entry = false;
      opens = true;
      result.blocks.emplace_back();
    }
    if (!result.blocks.empty()) module.count(operation, w, result.blocks.back());
    into.insert(into.end(), &spirv[at], &spirv[at] + (spirv[at] >> 16));
  });

  result.spirv.assign(spirv.begin(), spirv.begin() + kHeaderWords);
  result.spirv[kBoundWord] = bound;
  for (const auto* part : {&before, &counter.decorations, &types, &counter.declarations, &functions})
    result.spirv.insert(result.spirv.end(), part->begin(), part->end());
  return result;
}

}  // namespace lumivox::shader
