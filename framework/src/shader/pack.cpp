#include "lumivox/shader/pack.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"
#include "shader/bytes.h"

namespace lumivox::shader {
namespace {

constexpr std::string_view kMagic{"LVXSHPK\n", 8};
constexpr std::size_t kHeaderBytes = 8 + 4 + 8 + 16;  // magic, version, size and hash of the content
constexpr std::uint64_t kLimitBytes = std::uint64_t{1} << 30;
// Codes that are compressed together. Measured on the cone tracer's and near field's: 1 MiB expands in 0.3
// ms, once for each program that is loaded; 4 MiB take about half of the room in the file, 1/4 MiB 2.3
// and 2.8 times as much.
constexpr std::uint64_t kBlockBytes = std::uint64_t{1} << 20;

// One list of members for both directions: Archive is a ByteWriter or a ByteReader.
template <class Archive, class Binding>
void exchangeBinding(Archive& archive, Binding& binding) {
  archive.value(binding.name);
  archive.value(binding.kind);
  archive.value(binding.binding);
  archive.value(binding.type);
  archive.value(binding.textureKind);
  archive.value(binding.shadow);
  archive.value(binding.minimumBytes);
}

template <class Archive, class Program>
void exchangeProgram(Archive& archive, Program& program) {
  archive.value(program.name);
  archive.each(program.axes, [&](auto& axis) {
    archive.value(axis.name);
    archive.value(axis.values);
    archive.value(axis.named);
  });
  archive.each(program.constants, [&](auto& constant) {
    archive.value(constant.name);
    archive.value(constant.id);
    archive.value(constant.type);
    archive.value(constant.defaultBits);
  });
  archive.each(program.variants, [&](auto& variant) {
    archive.value(variant.values);
    archive.value(variant.bindingsUsed);
  });
}

void writeContent(ByteWriter& out, const ShaderPack& pack) {
  out.value(pack.technique);
  out.each(pack.programs, [&](const PackedProgram& program) {
    exchangeProgram(out, program);
    out.value(std::uint64_t{program.possible});
    out.each(program.bindings, [&](const PackedBinding& binding) {
      exchangeBinding(out, binding);
      out.value(static_cast<std::int32_t>(binding.format ? static_cast<int>(*binding.format) : -1));
    });
    for (const PackedVariant& variant : program.variants) {
      out.each(variant.stages, [&](const PackedStage& stage) {
        out.value(stage.stage);
        out.value(std::uint64_t{stage.code});
      });
    }
  });
  std::vector<std::span<const PackedCode>> blocks;
  for (auto code = pack.codes.begin(); code != pack.codes.end();) {
    const auto end = std::find_if(code, pack.codes.end(),
                                  [&](const PackedCode& other) { return other.block != code->block; });
    blocks.emplace_back(code, end);
    code = end;
  }
  out.each(blocks, [&](std::span<const PackedCode> codes) {
    out.value(codes.front().block->stream);
    out.each(codes, [&](const PackedCode& code) {
      out.value(code.hash.high);
      out.value(code.hash.low);
      out.value(code.bytes);
    });
  });
}

/// An index or enumerator out of range. The checksum was checked, so only a faulty writer can cause it.
struct OutOfRange {};

template <class Value>
void requireBelow(Value value, std::uint64_t end) {
  if (static_cast<std::uint64_t>(value) >= end) throw OutOfRange{};
}

/// Codes stay in place in the file's buffer.
void readContent(ByteReader& in, ShaderPack& pack, const std::shared_ptr<const std::string>& file) {
  constexpr std::uint64_t kFormats = static_cast<std::uint64_t>(gpu::Format::depth32f) + 1;
  in.value(pack.technique);
  in.each(pack.programs, [&](PackedProgram& program) {
    exchangeProgram(in, program);
    for (const PackedConstant& constant : program.constants) requireBelow(static_cast<int>(constant.type), 4);
    std::uint64_t possible = 0;
    in.value(possible);
    program.possible = possible;
    in.each(program.bindings, [&](PackedBinding& binding) {
      exchangeBinding(in, binding);
      requireBelow(static_cast<int>(binding.kind), 4);
      requireBelow(static_cast<int>(binding.textureKind), 3);
      std::int32_t format = -1;
      in.value(format);
      if (format != -1) {
        requireBelow(format, kFormats);
        binding.format = static_cast<gpu::Format>(format);
      }
    });
    for (PackedVariant& variant : program.variants) {
      if (variant.values.size() != program.axes.size()) throw OutOfRange{};
      for (const std::uint32_t used : variant.bindingsUsed) requireBelow(used, program.bindings.size());
      in.each(variant.stages, [&](PackedStage& stage) {
        in.value(stage.stage);
        requireBelow(static_cast<int>(stage.stage), 4);
        std::uint64_t code = 0;
        in.value(code);
        stage.code = code;
      });
    }
  });
  std::vector<std::vector<PackedCode>> blocks;
  in.each(blocks, [&](std::vector<PackedCode>& codes) {
    auto block = std::make_shared<Compressed>();
    block->stream = in.view();
    block->holder = file;
    in.each(codes, [&](PackedCode& code) {
      in.value(code.hash.high);
      in.value(code.hash.low);
      in.value(code.bytes);
      if (code.bytes % sizeof(std::uint32_t) != 0) throw OutOfRange{};
      requireBelow(code.bytes, kLimitBytes);
      code.block = block;
      code.first = block->expandedBytes;
      block->expandedBytes += code.bytes;
    });
    requireBelow(block->expandedBytes, kLimitBytes);
    pack.codes.insert(pack.codes.end(), codes.begin(), codes.end());
  });
  for (const PackedProgram& program : pack.programs) {
    for (const PackedVariant& variant : program.variants) {
      for (const PackedStage& stage : variant.stages) requireBelow(stage.code, pack.codes.size());
    }
  }
}

}  // namespace

int Axis::value(std::size_t index) const {
  if (named) return static_cast<int>(index);
  int number = 0;
  const std::string& text = values[index];
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

std::string Axis::text(int value) const {
  if (named && value >= 0 && static_cast<std::size_t>(value) < values.size())
    return values[static_cast<std::size_t>(value)];
  return std::to_string(value);
}

const char* name(BindingKind kind) {
  switch (kind) {
    case BindingKind::sampled:
      return "sampled texture";
    case BindingKind::image:
      return "image";
    case BindingKind::storage:
      return "storage buffer";
    case BindingKind::uniform:
      return "uniform block";
  }
  return "";
}

const PackedVariant* PackedProgram::find(VariantKey key) const {
  const auto found = std::find_if(variants.begin(), variants.end(), [&](const auto& variant) {
    return std::ranges::equal(variant.values, key);
  });
  return found == variants.end() ? nullptr : &*found;
}

std::string PackedProgram::text(const std::vector<int>& values) const {
  std::string text;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0) text += ' ';
    text += i < axes.size() ? axes[i].name + "=" + axes[i].text(values[i]) : std::to_string(values[i]);
  }
  return text;
}

std::vector<std::uint32_t> PackedCode::spirv() const {
  const std::string all = block->expanded();
  std::vector<std::uint32_t> words(bytes / sizeof(std::uint32_t));
  std::memcpy(words.data(), all.data() + first, words.size() * sizeof(std::uint32_t));
  return words;
}

std::vector<PackedCode> compressed(const std::vector<PlainCode>& codes) {
  std::vector<PackedCode> packed;
  std::string plain;
  std::size_t begin = 0;
  const auto closeBlock = [&] {
    const auto block = std::make_shared<const Compressed>(Compressed::of(plain));
    for (; begin < packed.size(); ++begin) packed[begin].block = block;
    plain.clear();
  };
  for (const PlainCode& code : codes) {
    const std::uint64_t bytes = code.spirv.size_bytes();
    if (!plain.empty() && plain.size() + bytes > kBlockBytes) closeBlock();
    packed.push_back({code.hash, nullptr, plain.size(), bytes});
    plain.append(reinterpret_cast<const char*>(code.spirv.data()), bytes);
  }
  if (!packed.empty()) closeBlock();
  return packed;
}

const PackedProgram& ShaderPack::program(const std::string& wanted) const {
  std::vector<std::string> names;
  for (const PackedProgram& program : programs) {
    if (program.name == wanted) return program;
    names.push_back(program.name);
  }
  throw Error(fmt::format("technique {} has no shader program '{}'; it has {}", technique, wanted,
                          fmt::join(names, ", ")));
}

ShaderPack readShaderPack(const std::filesystem::path& path) {
  const auto holder = std::make_shared<const std::string>(readFile(path, kLimitBytes));
  const std::string& file = *holder;
  const auto refuse = [&](const std::string& why) {
    throw Error(fmt::format("{}: {}; rebuild the shaders", path.string(), why));
  };
  if (std::string_view(file).substr(0, kMagic.size()) !=
          kMagic.substr(0, std::min(kMagic.size(), file.size())) ||
      file.empty()) {
    refuse("not a shader pack");
  }
  if (file.size() < kHeaderBytes) refuse("the shader pack is truncated");
  std::uint32_t version = 0;
  std::uint64_t size = 0;
  ContentHash expected;
  ByteReader header(std::string_view(file).substr(kMagic.size()));
  header.value(version);
  header.value(size);
  header.value(expected.high);
  header.value(expected.low);
  if (version != kPackVersion)
    refuse(fmt::format("the shader pack has version {}, expected {}", version, kPackVersion));
  const std::string_view content = std::string_view(file).substr(kHeaderBytes);
  if (content.size() < size) {
    refuse(fmt::format("the shader pack is truncated: {} of {} bytes", content.size(), size));
  }
  if (content.size() > size) refuse("the shader pack is followed by other data");
  if (hashOf(content) != expected) refuse("the shader pack is damaged (wrong checksum)");
  ShaderPack pack;
  pack.hash = expected;
  try {
    ByteReader reader(content);
    readContent(reader, pack, holder);
    if (!reader.atEnd()) refuse("the shader pack is damaged (more content than expected)");
  } catch (const Truncated&) {
    refuse("the shader pack is damaged (less content than expected)");
  } catch (const OutOfRange&) {
    refuse("the shader pack is damaged (an index is out of range)");
  }
  return pack;
}

void writeShaderPack(const std::filesystem::path& path, const ShaderPack& pack) {
  ByteWriter content;
  writeContent(content, pack);
  const ContentHash hash = hashOf(content.bytes());
  ByteWriter header;
  header.value(kPackVersion);
  header.value(std::uint64_t{content.bytes().size()});
  header.value(hash.high);
  header.value(hash.low);
  writeFileAtomically(path, std::string(kMagic) + header.bytes() + content.bytes());
}

}  // namespace lumivox::shader
