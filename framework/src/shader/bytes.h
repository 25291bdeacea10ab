// Values to bytes and back, for files that this machine writes for itself. Reading past the end or an absurd
// count throws Truncated.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace lumivox::shader {

struct Truncated {};

class ByteWriter {
 public:
  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void value(T v) { bytes_.append(reinterpret_cast<const char*>(&v), sizeof(v)); }
  void value(std::string_view text) {
    value(static_cast<std::uint32_t>(text.size()));
    bytes_.append(text);
  }
  void value(const std::string& text) { value(std::string_view(text)); }
  template <class T>
  void value(const std::vector<T>& values) {
    each(values, [this](const T& v) { value(v); });
  }
  template <class Values, class Write>
  void each(const Values& values, Write&& write) {
    value(static_cast<std::uint32_t>(values.size()));
    for (const auto& v : values) write(v);
  }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}

  template <class T>
  requires std::is_arithmetic_v<T> || std::is_enum_v<T>
  void value(T& v) { take(&v, sizeof(v)); }
  void value(bool& v) {
    std::uint8_t byte = 0;
    value(byte);
    v = byte != 0;
  }
  void value(std::string& text) {
    text.resize(count());
    take(text.data(), text.size());
  }
  /// A view of a text in the buffer.
  std::string_view view() {
    const std::size_t size = count();
    const std::string_view text = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return text;
  }
  template <class T>
  void value(std::vector<T>& values) {
    each(values, [this](T& v) { value(v); });
  }
  template <class T, class Read>
  void each(std::vector<T>& values, Read&& read) {
    // Grows with the elements read, so that a wrong count takes no more memory than the file's bytes.
    values.clear();
    for (std::size_t rest = count(); rest > 0; --rest) read(values.emplace_back());
  }
  bool atEnd() const { return rest_.empty(); }

 private:
  /// A number of elements of at least one byte each.
  std::size_t count() {
    std::uint32_t n = 0;
    value(n);
    if (n > rest_.size()) throw Truncated{};
    return n;
  }
  void take(void* target, std::size_t size) {
    if (size > rest_.size()) throw Truncated{};
    std::memcpy(target, rest_.data(), size);
    rest_.remove_prefix(size);
  }
  std::string_view rest_;
};

}  // namespace lumivox::shader
