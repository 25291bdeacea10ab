// Accessors of glTF 2.0: all component types, strides, normalised integers and sparse values.
#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "lumivox/base/file.h"
#include "scene/gltf_document.h"
#include "scene/parallel.h"

namespace lumivox {
namespace {

constexpr unsigned kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123,
                   kUnsignedInt = 5125, kFloat = 5126;

std::size_t sizeOfType(unsigned type, const GltfValue& place) {
  switch (type) {
    case kByte:
    case kUnsignedByte:
      return 1;
    case kShort:
    case kUnsignedShort:
      return 2;
    case kUnsignedInt:
    case kFloat:
      return 4;
    default:
      place.refuse(fmt::format("is {}", type), "5120, 5121, 5122, 5123, 5125 or 5126");
  }
}

template <class T>
T loaded(const char* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

std::uint32_t wholeNumber(const char* at, unsigned type) {
  switch (type) {
    case kUnsignedByte:
      return loaded<std::uint8_t>(at);
    case kUnsignedShort:
      return loaded<std::uint16_t>(at);
    default:
      return loaded<std::uint32_t>(at);
  }
}

void requireWhole(unsigned type, const GltfValue& place) {
  if (type != kUnsignedByte && type != kUnsignedShort && type != kUnsignedInt)
    place.refuse(fmt::format("indices of component type {}", type), "5121, 5123 or 5125, unsigned integers");
}

}  // namespace

GltfAccessor::GltfAccessor(GltfDocument& document, std::size_t index)
    : place_(document.root().item("accessors", index)) {
  constexpr std::uint64_t kMostElements = 1'000'000'000;
  count_ = place_.member("count").asWhole(kMostElements);
  type_ = static_cast<unsigned>(place_.member("componentType").asWhole(65535));
  componentSize_ = sizeOfType(type_, place_.member("componentType"));
  normalised_ = place_.flag("normalized", false);
  const std::string type = place_.member("type").asText();
  constexpr std::pair<const char*, std::size_t> kTypes[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}};
  const auto* known =
      std::find_if(std::begin(kTypes), std::end(kTypes), [&](const auto& one) { return type == one.first; });
  if (known == std::end(kTypes))
    place_.member("type").refuse("is an unknown type", "SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4");
  components_ = known->second;
  const std::size_t size = components_ * componentSize_;
  stride_ = size;
  const auto view = place_.index("bufferView", document.root().count("bufferViews"), "buffer views");
  if (view) {
    const GltfDocument::View bytes = document.view(*view);
    if (bytes.stride != 0) stride_ = bytes.stride;
    const std::size_t offset = place_.whole("byteOffset", 0, kLargestModelFile);
    if (stride_ < size)
      place_.refuse(fmt::format("elements of {} bytes with a stride of {}", size, stride_),
                    "a stride of at least one element");
    if (count_ > 0 && (offset > bytes.bytes.size() || bytes.bytes.size() - offset < size ||
                       (bytes.bytes.size() - offset - size) / stride_ < count_ - 1))
      place_.refuse(fmt::format("{} elements of {} bytes from byte {} on, of a buffer view of {} bytes",
                                count_, stride_, offset, bytes.bytes.size()),
                    "elements within the buffer view");
    data_ = bytes.bytes.data() + offset;
  }
  constexpr std::uint64_t kMostZeros = std::uint64_t{1} << 24;
  if (!view && count_ > kMostZeros)
    place_.refuse(fmt::format("{} elements without a buffer view", count_),
                  fmt::format("at most {}, which sparse values fill", kMostZeros));
  // The largest use of an accessor takes 4 bytes a component.
  requireMemory(count_ * components_ * sizeof(float), document.file().string() + ": " + place_.pointer());
  readSparse(document);
}

void GltfAccessor::readSparse(GltfDocument& document) {
  const auto sparse = place_.find("sparse");
  if (!sparse) return;
  const std::size_t count = sparse->member("count").asWhole(count_);
  const GltfValue indices = sparse->member("indices"), values = sparse->member("values");
  const auto type = static_cast<unsigned>(indices.member("componentType").asWhole(65535));
  requireWhole(type, indices.member("componentType"));
  const auto bytesOf = [&](const GltfValue& place, std::size_t size) {
    const std::string_view bytes =
        document
            .view(place.member("bufferView").asIndex(document.root().count("bufferViews"), "buffer views"))
            .bytes;
    const std::size_t offset = place.whole("byteOffset", 0, kLargestModelFile);
    if (offset > bytes.size() || (bytes.size() - offset) / size < count)
      place.refuse(fmt::format("{} elements from byte {} on, of a buffer view of {} bytes", count, offset,
                               bytes.size()),
                   "elements within the buffer view");
    return bytes.substr(offset, count * size);
  };
  const std::size_t indexSize = sizeOfType(type, indices);
  const std::string_view indexBytes = bytesOf(indices, indexSize);
  sparseValues_ = bytesOf(values, components_ * componentSize_);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t index = wholeNumber(indexBytes.data() + i * indexSize, type);
    if (index >= count_)
      indices.refuse(fmt::format("index {} is {}", i, index), fmt::format("indices below {}", count_));
    sparseIndices_.push_back(index);
  }
}

const GltfAccessor& GltfAccessor::require(std::initializer_list<std::size_t> components,
                                          const char* what) const {
  if (std::find(components.begin(), components.end(), components_) == components.end())
    place_.refuse(fmt::format("{} of {} components", what, components_),
                  fmt::format("{}", fmt::join(components, " or ")));
  return *this;
}

float GltfAccessor::component(const char* at) const {
  switch (type_) {
    case kByte: {
      const float value = loaded<std::int8_t>(at);
      return normalised_ ? std::max(value / 127.0f, -1.0f) : value;
    }
    case kUnsignedByte:
      return static_cast<float>(loaded<std::uint8_t>(at)) / (normalised_ ? 255.0f : 1.0f);
    case kShort: {
      const float value = loaded<std::int16_t>(at);
      return normalised_ ? std::max(value / 32767.0f, -1.0f) : value;
    }
    case kUnsignedShort:
      return static_cast<float>(loaded<std::uint16_t>(at)) / (normalised_ ? 65535.0f : 1.0f);
    case kUnsignedInt:
      return static_cast<float>(loaded<std::uint32_t>(at));
    default:
      return loaded<float>(at);
  }
}

/// `values` has one element for each of the accessor, or one for each component.
template <class Element>
void GltfAccessor::fill(std::vector<Element>& values) const {
  auto* const floats = reinterpret_cast<float*>(values.data());
  const bool isPlain = type_ == kFloat && stride_ == components_ * sizeof(float);
  inParallel(data_ == nullptr ? 0 : count_, [&](std::size_t begin, std::size_t end) {
    if (isPlain) {
      if (end > begin)
        std::memcpy(floats + begin * components_, data_ + begin * stride_, (end - begin) * stride_);
      return;
    }
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t c = 0; c < components_; ++c)
        floats[i * components_ + c] = component(data_ + i * stride_ + c * componentSize_);
  });
  for (std::size_t i = 0; i < sparseIndices_.size(); ++i)
    for (std::size_t c = 0; c < components_; ++c)
      floats[sparseIndices_[i] * components_ + c] =
          component(sparseValues_.data() + (i * components_ + c) * componentSize_);
}

std::vector<float> GltfAccessor::floats() const {
  std::vector<float> values(count_ * components_);
  fill(values);
  return values;
}

/// Vectors of floats that lie side by side are copied at once: memory is touched only once.
template <class Vector>
std::vector<Vector> GltfAccessor::elements() const {
  static_assert(sizeof(Vector) == static_cast<std::size_t>(Vector::length()) * sizeof(float));
  const bool isAligned = reinterpret_cast<std::uintptr_t>(data_) % alignof(Vector) == 0;
  if (data_ != nullptr && type_ == kFloat && stride_ == sizeof(Vector) && isAligned &&
      sparseIndices_.empty()) {
    const void* first = data_;
    return {static_cast<const Vector*>(first), static_cast<const Vector*>(first) + count_};
  }
  std::vector<Vector> values(count_);
  fill(values);
  return values;
}

std::vector<glm::vec3> GltfAccessor::vectors3() const {
  require({3}, "vectors");
  return elements<glm::vec3>();
}

std::vector<glm::vec2> GltfAccessor::vectors2() const {
  require({2}, "vectors");
  return elements<glm::vec2>();
}

std::vector<std::uint32_t> GltfAccessor::indices() const {
  require({1}, "indices");
  requireWhole(type_, place_.member("componentType"));
  const bool isAligned = reinterpret_cast<std::uintptr_t>(data_) % alignof(std::uint32_t) == 0;
  if (data_ != nullptr && type_ == kUnsignedInt && stride_ == sizeof(std::uint32_t) && isAligned &&
      sparseIndices_.empty()) {
    const void* first = data_;
    return {static_cast<const std::uint32_t*>(first), static_cast<const std::uint32_t*>(first) + count_};
  }
  std::vector<std::uint32_t> values(count_);
  inParallel(data_ == nullptr ? 0 : count_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) values[i] = wholeNumber(data_ + i * stride_, type_);
  });
  for (std::size_t i = 0; i < sparseIndices_.size(); ++i)
    values[sparseIndices_[i]] = wholeNumber(sparseValues_.data() + i * componentSize_, type_);
  return values;
}

}  // namespace lumivox
