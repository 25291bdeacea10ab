#include "scene/gltf_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "lumivox/base/error.h"
#include "lumivox/base/file.h"

namespace lumivox {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLargestJson = std::uint64_t{1} << 30;
// Measured on arrays of one-digit numbers, the densest text: 16 bytes a value, twice while an array grows.
constexpr std::uint64_t kMemoryPerByte = 24;

std::uint32_t littleEndian32(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// Base64 (RFC 4648); nothing if the text is none.
std::optional<std::string> decodedBase64(std::string_view text) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  std::string result;
  result.reserve(text.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    std::uint32_t digit = 0;
    if (c >= 'A' && c <= 'Z')
      digit = static_cast<std::uint32_t>(c - 'A');
    else if (c >= 'a' && c <= 'z')
      digit = static_cast<std::uint32_t>(c - 'a') + 26;
    else if (c >= '0' && c <= '9')
      digit = static_cast<std::uint32_t>(c - '0') + 52;
    else if (c == '+' || c == '-')
      digit = 62;
    else if (c == '/' || c == '_')
      digit = 63;
    else
      return std::nullopt;
    bits = bits << 6 | digit;
    count += 6;
    if (count >= 8) {
      count -= 8;
      result += static_cast<char>(bits >> count & 0xFFu);
    }
  }
  return result;
}

std::string shortened(const std::string& text) {
  constexpr std::size_t kShown = 60;
  return text.size() > kShown ? text.substr(0, kShown) + "..." : text;
}

}  // namespace

void GltfValue::refuse(const std::string& what, const std::string& expected) const {
  throw Error(fmt::format("{}: {}: {}; expected {}", file_->string(), pointer_.empty() ? "/" : pointer_, what,
                          expected));
}

bool GltfValue::has(const char* name) const {
  return json_->is_object() && json_->contains(name);
}

std::optional<GltfValue> GltfValue::find(const char* name) const {
  if (!json_->is_object()) refuse("is no object", "a JSON object");
  const auto found = json_->find(name);
  if (found == json_->end()) return std::nullopt;
  return GltfValue(&*found, pointer_ + '/' + name, file_);
}

GltfValue GltfValue::member(const char* name) const {
  if (auto found = find(name)) return *std::move(found);
  refuse(fmt::format("lacks '{}'", name), fmt::format("an object with '{}'", name));
}

std::size_t GltfValue::size() const {
  if (!json_->is_array()) refuse("is no array", "a JSON array");
  return json_->size();
}

std::size_t GltfValue::count(const char* name) const {
  const auto found = find(name);
  return found ? found->size() : 0;
}

GltfValue GltfValue::at(std::size_t index) const {
  return {&(*json_)[index], fmt::format("{}/{}", pointer_, index), file_};
}

GltfValue GltfValue::item(const char* name, std::size_t index) const {
  const GltfValue result = member(name).at(index);
  if (!result.json_->is_object()) result.refuse("is no object", "a JSON object");
  return result;
}

std::vector<std::string> GltfValue::names() const {
  std::vector<std::string> result;
  if (json_->is_object())
    for (const auto& [name, value] : json_->items()) result.push_back(name);
  return result;
}

double GltfValue::asNumber(double low, double high) const {
  if (!json_->is_number()) refuse("is no number", "a number");
  const double value = json_->get<double>();
  if (!(value >= low && value <= high))
    refuse(fmt::format("is {}", value), fmt::format("a number from {} to {}", low, high));
  return value;
}

std::uint64_t GltfValue::asWhole(std::uint64_t most) const {
  const std::string expected = fmt::format("a whole number from 0 to {}", most);
  if (!json_->is_number()) refuse("is no number", expected);
  const double value = json_->get<double>();
  if (!(value >= 0.0 && value <= static_cast<double>(most)) || value != std::floor(value))
    refuse(fmt::format("is {}", value), expected);
  return static_cast<std::uint64_t>(value);
}

std::string GltfValue::asText() const {
  if (!json_->is_string()) refuse("is no text", "a string");
  return json_->get<std::string>();
}

double GltfValue::number(const char* name, double fallback, double low, double high) const {
  const auto found = find(name);
  return found ? found->asNumber(low, high) : fallback;
}

std::uint64_t GltfValue::whole(const char* name, std::uint64_t fallback, std::uint64_t most) const {
  const auto found = find(name);
  return found ? found->asWhole(most) : fallback;
}

bool GltfValue::flag(const char* name, bool fallback) const {
  const auto found = find(name);
  if (!found) return fallback;
  if (!found->json_->is_boolean()) found->refuse("is no truth value", "true or false");
  return found->json_->get<bool>();
}

std::string GltfValue::text(const char* name, const std::string& fallback) const {
  const auto found = find(name);
  return found ? found->asText() : fallback;
}

std::optional<std::vector<double>> GltfValue::numbers(const char* name, std::size_t count, double low,
                                                      double high) const {
  const auto found = find(name);
  if (!found) return std::nullopt;
  if (found->size() != count)
    found->refuse(fmt::format("has {} values", found->size()), fmt::format("{} numbers", count));
  std::vector<double> result;
  for (std::size_t i = 0; i < count; ++i) result.push_back(found->at(i).asNumber(low, high));
  return result;
}

std::size_t GltfValue::asIndex(std::size_t count, const char* what) const {
  if (!json_->is_number_integer() || json_->get<double>() < 0.0 ||
      json_->get<double>() >= static_cast<double>(count))
    refuse(fmt::format("is {}", shortened(json_->is_number() ? json_->dump() : std::string("no number"))),
           fmt::format("the index of one of {} {}", count, what));
  return json_->get<std::size_t>();
}

std::optional<std::size_t> GltfValue::index(const char* name, std::size_t count, const char* what) const {
  const auto found = find(name);
  if (!found) return std::nullopt;
  return found->asIndex(count, what);
}

GltfDocument::GltfDocument(const fs::path& file, Hasher& hasher) : file_(file), hasher_(hasher) {
  bytes_ = readFile(file, kLargestModelFile);
  hasher.add(bytes_);
  readContainer(hasher);
  if (!json_.is_object()) root().refuse("is no object", "a glTF document");
  const std::string version = root().member("asset").member("version").asText();
  if (version.substr(0, 2) != "2.")
    root().member("asset").member("version").refuse(fmt::format("is '{}'", shortened(version)), "2.0");
  if (const auto least = root().member("asset").find("minVersion"); least && least->asText() != "2.0")
    least->refuse(fmt::format("is '{}'", shortened(least->asText())), "2.0");
}

void GltfDocument::readContainer(Hasher&) {
  constexpr std::size_t kHeader = 12, kChunkHeader = 8;
  constexpr std::uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;
  const auto refuse = [&](std::size_t at, const std::string& what, const std::string& expected) {
    throw Error(fmt::format("{}: byte {}: {}; expected {}", file_.string(), at, what, expected));
  };
  if (bytes_.substr(0, 4) != "glTF") return parse(bytes_);
  if (bytes_.size() < kHeader + kChunkHeader)
    refuse(bytes_.size(), "the file ends", "a GLB header and chunks");
  if (littleEndian32(bytes_, 4) != 2)
    refuse(4, fmt::format("version {} of GLB", littleEndian32(bytes_, 4)), "version 2");
  const std::size_t length = littleEndian32(bytes_, 8);
  if (length > bytes_.size() || length < kHeader + kChunkHeader)
    refuse(8, fmt::format("a length of {} bytes in a file of {}", length, bytes_.size()),
           "the length of the file (is it truncated?)");
  std::string_view json;
  bool first = true;
  for (std::size_t at = kHeader; at < length; first = false) {
    if (length - at < kChunkHeader) refuse(at, "half the header of a chunk", "a whole one");
    const std::size_t size = littleEndian32(bytes_, at);
    const std::uint32_t type = littleEndian32(bytes_, at + 4);
    at += kChunkHeader;
    if (size > length - at)
      refuse(at, fmt::format("a chunk of {} bytes where {} are left", size, length - at), "a whole chunk");
    const std::string_view chunk = std::string_view(bytes_).substr(at, size);
    if (first && type != kJson) refuse(at - 4, "a first chunk of another type", "a chunk JSON");
    if (first) json = chunk;
    if (!first && type == kBinary && !hasBinary_) {
      binary_ = chunk;
      hasBinary_ = true;
    }
    at += size;
  }
  parse(json);
}

void GltfDocument::parse(std::string_view text) {
  if (text.size() > kLargestJson)
    throw Error(fmt::format("{}: {} of JSON; expected at most {}", file_.string(), formatBytes(text.size()),
                            formatBytes(kLargestJson)));
  requireMemory(
      std::min<std::uint64_t>(kMemoryPerByte *
                                      static_cast<std::uint64_t>(std::count(text.begin(), text.end(), ',') +
                                                                 std::count(text.begin(), text.end(), '[') +
                                                                 std::count(text.begin(), text.end(), '{')) *
                                      2 +
                                  text.size(),
                              kMemoryPerByte * text.size()),
      file_.string());
  try {
    json_ = nlohmann::json::parse(text.begin(), text.end());
  } catch (const nlohmann::json::exception& error) {
    std::string reason = error.what();
    if (const std::size_t at = reason.find("] "); at != std::string::npos) reason = reason.substr(at + 2);
    throw Error(fmt::format("{}: is no JSON: {}; expected a glTF 2.0 file", file_.string(), reason));
  }
}

std::optional<std::string> GltfDocument::dataOf(const std::string& uri, const GltfValue& place) {
  if (uri.substr(0, 5) != "data:") return std::nullopt;
  const std::size_t comma = uri.find(',');
  constexpr std::string_view kEncoding = ";base64";
  if (comma == std::string::npos || comma < kEncoding.size() ||
      uri.substr(comma - kEncoding.size(), kEncoding.size()) != kEncoding)
    place.refuse("a data: URI of another encoding", "data:TYPE;base64,BYTES");
  requireMemory(uri.size(), place.pointer());
  auto bytes = decodedBase64(std::string_view(uri).substr(comma + 1));
  if (!bytes) place.refuse("a data: URI that is no base64", "letters, digits, + and /");
  return bytes;
}

fs::path GltfDocument::fileOf(const std::string& uri, const GltfValue& place) const {
  std::string name;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const auto hexadecimal = [&](std::size_t at) {
      const char c = at < uri.size() ? uri[at] : 'x';
      return c >= '0' && c <= '9'   ? c - '0'
             : c >= 'a' && c <= 'f' ? c - 'a' + 10
             : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                    : -1;
    };
    if (uri[i] == '%' && hexadecimal(i + 1) >= 0 && hexadecimal(i + 2) >= 0) {
      name += static_cast<char>(16 * hexadecimal(i + 1) + hexadecimal(i + 2));
      i += 2;
    } else {
      name += uri[i];
    }
  }
  std::replace(name.begin(), name.end(), '\\', '/');
  const fs::path relative = fs::path(name).lexically_normal();
  const bool hasScheme = name.find(':') != std::string::npos;
  if (name.empty() || name.find('\0') != std::string::npos || hasScheme || relative.is_absolute() ||
      *relative.begin() == "..")
    place.refuse(fmt::format("the URI '{}' names nothing in the folder of the file", shortened(name)),
                 "a relative path that does not leave the folder");
  return file_.parent_path() / relative;
}

std::string_view GltfDocument::buffer(std::size_t index) {
  const GltfValue place = root().item("buffers", index);
  const std::size_t length = place.member("byteLength").asWhole(kLargestModelFile);
  std::string_view bytes;
  if (!place.has("uri")) {
    if (index != 0 || !hasBinary_) place.refuse("lacks 'uri'", "one, or the chunk BIN of a .glb file");
    bytes = binary_;
  } else {
    auto found = buffers_.find(index);
    if (found == buffers_.end()) {
      const std::string uri = place.member("uri").asText();
      auto data = dataOf(uri, place.member("uri"));
      if (!data) {
        const fs::path file = fileOf(uri, place.member("uri"));
        std::error_code error;
        if (!fs::exists(file, error))
          place.member("uri").refuse(fmt::format("the file '{}' does not exist", shortened(uri)),
                                     fmt::format("it at {}", file.string()));
        data = readFile(file, kLargestModelFile);
        hasher_.add(*data);
      }
      found = buffers_.emplace(index, *std::move(data)).first;
    }
    bytes = found->second;
  }
  if (bytes.size() < length)
    place.member("byteLength")
        .refuse(fmt::format("is {}, and the buffer has {} bytes", length, bytes.size()),
                "at most that (is it truncated?)");
  return bytes.substr(0, length);
}

GltfDocument::View GltfDocument::view(std::size_t index) {
  const GltfValue place = root().item("bufferViews", index);
  const std::string_view bytes = buffer(place.member("buffer").asIndex(root().count("buffers"), "buffers"));
  const std::size_t offset = place.whole("byteOffset", 0, kLargestModelFile);
  const std::size_t length = place.member("byteLength").asWhole(kLargestModelFile);
  if (offset > bytes.size() || length > bytes.size() - offset)
    place.refuse(fmt::format("bytes {} to {} of a buffer of {}", offset, offset + length, bytes.size()),
                 "bytes within the buffer");
  View result;
  result.bytes = bytes.substr(offset, length);
  result.stride = place.whole("byteStride", 0, 252);
  return result;
}

}  // namespace lumivox
