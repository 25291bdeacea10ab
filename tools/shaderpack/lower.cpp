// Drivers expand matrix products, normalize and asin differently, and one driver differs between SPIR-V and
// GLSL. This pass replaces them by sums and products in a fixed order, so that all drivers compute the same
// expression from either form.
#include <spirv/unified1/GLSL.std.450.h>

#include <cassert>
#include <map>
#include <set>
#include <spirv/unified1/spirv.hpp>

#include "stage.h"

namespace lumivox::shaderpack {
namespace {

using Id = std::uint32_t;
using Words = std::vector<std::uint32_t>;

struct Instruction {
  spv::Op operation;
  Words operands;
};

class Lowering {
 public:
  explicit Lowering(const Words& words) : header_(words.begin(), words.begin() + 5) {
    for (std::size_t at = 5; at < words.size();) {
      const std::uint32_t length = words[at] >> 16;
      assert(length > 0 && at + length <= words.size());
      const auto first = words.begin() + static_cast<std::ptrdiff_t>(at);
      module_.push_back({static_cast<spv::Op>(words[at] & 0xffffu), Words(first + 1, first + length)});
      at += length;
    }
  }

  Words run() {
    for (const Instruction& instruction : module_) learn(instruction);
    std::size_t firstType = module_.size(), firstFunction = module_.size();
    Words body;
    for (std::size_t i = 0; i < module_.size(); ++i) {
      const Instruction& instruction = module_[i];
      if (firstType == module_.size() && isType(instruction.operation)) firstType = i;
      if (firstFunction == module_.size() && instruction.operation == spv::OpFunction) firstFunction = i;
      if (firstFunction == module_.size()) continue;
      code_ = &body;
      if (!lower(instruction)) emit(instruction);
    }
    Words result = header_;
    result[3] = bound();
    for (std::size_t i = 0; i < firstFunction; ++i) {
      if (i == firstType) result.insert(result.end(), decorations_.begin(), decorations_.end());
      append(result, module_[i]);
    }
    result.insert(result.end(), constants_.begin(), constants_.end());
    result.insert(result.end(), body.begin(), body.end());
    return result;
  }

 private:
  static bool isType(spv::Op operation) {
    return operation >= spv::OpTypeVoid && operation <= spv::OpTypeForwardPointer;
  }
  static bool isArithmetic(spv::Op operation) {
    switch (operation) {
      case spv::OpFNegate:
      case spv::OpFAdd:
      case spv::OpFSub:
      case spv::OpFMul:
      case spv::OpFDiv:
      case spv::OpFRem:
      case spv::OpFMod:
      case spv::OpVectorTimesScalar:
      case spv::OpMatrixTimesScalar:
      case spv::OpOuterProduct:
      case spv::OpDot:
        return true;
      default:
        return false;
    }
  }
  static void append(Words& words, const Instruction& instruction) {
    words.push_back(
        static_cast<std::uint32_t>((instruction.operands.size() + 1) << 16 | instruction.operation));
    words.insert(words.end(), instruction.operands.begin(), instruction.operands.end());
  }
  Id& bound() { return header_[3]; }

  void learn(const Instruction& instruction) {
    const Words& w = instruction.operands;
    switch (instruction.operation) {
      case spv::OpTypeVector:
      case spv::OpTypeMatrix:
        composites_[w[0]] = {w[1], w[2]};
        break;
      case spv::OpExtInstImport:
        library_ = w[0];
        break;
      case spv::OpDecorate:
        if (w[1] == spv::DecorationNoContraction) marked_.insert(w[0]);
        break;
      case spv::OpName:
      case spv::OpMemberName:
      case spv::OpMemberDecorate:
        break;
      default:
        // The first word of an instruction with a result is its type. Callers ask only for floats and their
        // composites.
        if (isType(instruction.operation)) {
          types_.insert(w[0]);
        } else if (w.size() >= 2 && (types_.contains(w[0]) || composites_.contains(w[0]))) {
          typeOf_[w[1]] = w[0];
        }
    }
  }

  /// Emits an instruction with a new result of the given type.
  Id emit(spv::Op operation, Id type, Words operands) {
    const Id result = bound()++;
    emitAs(operation, type, result, std::move(operands));
    return result;
  }
  void emitAs(spv::Op operation, Id type, Id result, Words operands) {
    operands.insert(operands.begin(), {type, result});
    emit({operation, std::move(operands)});
  }
  void emit(const Instruction& instruction) {
    append(*code_, instruction);
    if (!isArithmetic(instruction.operation) || !marked_.insert(instruction.operands[1]).second) return;
    append(decorations_, {spv::OpDecorate, {instruction.operands[1], spv::DecorationNoContraction}});
  }
  Id element(Id composite, Id elementType, std::uint32_t index) {
    return emit(spv::OpCompositeExtract, elementType, {composite, index});
  }
  Id library(GLSLstd450 function, Id type, Words arguments) {
    arguments.insert(arguments.begin(), {library_, static_cast<std::uint32_t>(function)});
    return emit(spv::OpExtInst, type, std::move(arguments));
  }

  /// matrix * vector = column 0 * x + column 1 * y + ..., summed from the left. The last sum gets the id
  /// `result` unless that is 0.
  Id matrixTimesVector(Id matrix, Id vector, Id columnType, std::uint32_t columns, Id result) {
    const Id scalarType = composites_.at(columnType).element;
    Id sum = 0;
    for (std::uint32_t i = 0; i < columns; ++i) {
      const Id column = element(matrix, columnType, i), weight = element(vector, scalarType, i);
      const Id product = emit(spv::OpVectorTimesScalar, columnType, {column, weight});
      if (i == 0) {
        sum = product;
      } else if (i + 1 == columns && result != 0) {
        emitAs(spv::OpFAdd, columnType, result, {sum, product});
      } else {
        sum = emit(spv::OpFAdd, columnType, {sum, product});
      }
    }
    return sum;
  }

  bool lower(const Instruction& instruction) {
    const Words& w = instruction.operands;
    switch (instruction.operation) {
      case spv::OpMatrixTimesVector:
        matrixTimesVector(w[2], w[3], w[0], composites_.at(typeOf_.at(w[2])).count, w[1]);
        return true;
      case spv::OpVectorTimesMatrix: {
        const Composite matrix = composites_.at(typeOf_.at(w[3]));
        const Id scalarType = composites_.at(w[0]).element;
        Words products;
        for (std::uint32_t i = 0; i < matrix.count; ++i) {
          products.push_back(emit(spv::OpDot, scalarType, {w[2], element(w[3], matrix.element, i)}));
        }
        emitAs(spv::OpCompositeConstruct, w[0], w[1], products);
        return true;
      }
      case spv::OpMatrixTimesMatrix: {
        const Composite result = composites_.at(w[0]), left = composites_.at(typeOf_.at(w[2])),
                        right = composites_.at(typeOf_.at(w[3]));
        Words columns;
        for (std::uint32_t i = 0; i < result.count; ++i) {
          columns.push_back(
              matrixTimesVector(w[2], element(w[3], right.element, i), result.element, left.count, 0));
        }
        emitAs(spv::OpCompositeConstruct, w[0], w[1], columns);
        return true;
      }
      case spv::OpExtInst:
        return w[2] == library_ && lowerFunction(w[0], w[1], static_cast<GLSLstd450>(w[3]), w);
      default:
        return false;
    }
  }

  bool lowerFunction(Id type, Id result, GLSLstd450 function, const Words& w) {
    const auto composite = composites_.find(type);
    if (function == GLSLstd450Normalize && composite != composites_.end()) {
      const Id scalarType = composite->second.element;
      const Id squared = emit(spv::OpDot, scalarType, {w[4], w[4]});
      emitAs(spv::OpVectorTimesScalar, type, result,
             {w[4], library(GLSLstd450InverseSqrt, scalarType, {squared})});
      return true;
    }
    if (function == GLSLstd450Asin) {
      // asin x = atan(x / sqrt((1 - x) (1 + x)))
      const Id one = constantOne(type);
      const Id below = emit(spv::OpFSub, type, {one, w[4]}), above = emit(spv::OpFAdd, type, {one, w[4]});
      const Id cosine = library(GLSLstd450Sqrt, type, {emit(spv::OpFMul, type, {below, above})});
      emitAs(spv::OpExtInst, type, result, {library_, GLSLstd450Atan2, w[4], cosine});
      return true;
    }
    return false;
  }

  Id constantOne(Id type) {
    Id& one = ones_[type];
    if (one != 0) return one;
    const auto composite = composites_.find(type);
    if (composite == composites_.end()) {
      constexpr std::uint32_t kOneBits = 0x3f800000u;
      one = bound()++;
      append(constants_, {spv::OpConstant, {type, one, kOneBits}});
      return one;
    }
    const Id scalar = constantOne(composite->second.element);
    const Id vector = bound()++;
    Words operands{type, vector};
    operands.insert(operands.end(), composite->second.count, scalar);
    append(constants_, {spv::OpConstantComposite, operands});
    return ones_[type] = vector;
  }

  struct Composite {
    Id element = 0;
    std::uint32_t count = 0;
  };
  Words header_;
  std::vector<Instruction> module_;
  std::map<Id, Composite> composites_;  // vector and matrix types
  std::set<Id> types_, marked_;
  std::map<Id, Id> typeOf_, ones_;
  Id library_ = 0;
  Words decorations_, constants_;
  Words* code_ = nullptr;
};

}  // namespace

std::vector<std::uint32_t> lowerToPlainArithmetic(const std::vector<std::uint32_t>& words) {
  return Lowering(words).run();
}

}  // namespace lumivox::shaderpack
