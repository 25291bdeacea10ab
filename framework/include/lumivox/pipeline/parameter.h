// Parameters of a pass: numbers, switches and words, with range, unit, default and published value.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace lumivox {

class Pass;

/// A parameter of a pass: a number, a switch (on/off) or a word, with its range, its default and, if the
/// paper gives one, its published value. Set from the pipeline text.
class ParamBase {
 public:
  enum class Type { integer, number, flag, word };
  ParamBase(Pass* pass, std::string name, Type type, std::string meaning);
  virtual ~ParamBase() = default;
  ParamBase(const ParamBase&) = delete;
  ParamBase& operator=(const ParamBase&) = delete;
  const std::string& name() const { return name_; }
  Type type() const { return type_; }
  virtual std::string meaning() const { return meaning_; }
  double low() const { return low_; }
  double high() const { return high_; }
  const std::vector<std::string>& choices() const { return choices_; }
  const std::string& unit() const { return unit_; }  ///< "", "m", "rad", "/m"
  virtual std::string valueText() const = 0;
  virtual std::string defaultText() const = 0;
  virtual std::string publishedText() const = 0;  ///< empty: the paper does not say
  /// Marks the value as given by a text, so that `as_published` does not change it (Pass::applyPublished).
  void state() { stated_ = true; }
  bool isStated() const { return stated_; }
  virtual void setDefault() = 0;
  virtual void setPublished() = 0;  ///< precondition: there is a published value
  /// "must be a whole number in 1..32" when the value does not fit (it then stays as it was), else empty.
  /// Numbers arrive in base units.
  virtual std::string set(double number) = 0;
  virtual std::string set(const std::string& word) = 0;

 protected:
  /// Called by the constructor of a parameter with a published value.
  static void addPublishedForm(Pass* pass);
  double low_ = 0, high_ = 0;
  std::vector<std::string> choices_;
  std::string unit_;

 private:
  std::string name_, meaning_;
  Type type_;
  bool stated_ = false;
};

/// A parameter's value in the paper: the last word of its declaration. A pass with such a parameter has the
/// switch `as_published`, which sets all of them.
template <class T>
struct PublishedValue {
  T value;
};
template <class T>
constexpr PublishedValue<T> published(T value) {
  return {value};
}
template <class T>
using MaybePublished = std::optional<PublishedValue<T>>;

template <class T>
struct ParamRange {
  T low, high;
};
/// The range of a parameter, its ends included.
template <class T>
constexpr ParamRange<T> within(T low, T high) {
  return {low, high};
}

template <class T>
class Param;

template <>
class Param<int> : public ParamBase {
 public:
  Param(Pass* pass, std::string name, int value, ParamRange<int> range, std::string meaning,
        MaybePublished<int> printed = {});
  operator int() const { return value_; }
  std::string valueText() const override;
  std::string defaultText() const override;
  std::string publishedText() const override;
  void setDefault() override { value_ = default_; }
  void setPublished() override { value_ = published_->value; }
  std::string set(double number) override;
  std::string set(const std::string& word) override;

 private:
  int value_, default_;
  MaybePublished<int> published_;
};

template <>
class Param<float> : public ParamBase {
 public:
  Param(Pass* pass, std::string name, float value, ParamRange<float> range, std::string unit,
        std::string meaning, MaybePublished<float> printed = {});
  /// A pure number.
  Param(Pass* pass, std::string name, float value, ParamRange<float> range, std::string meaning,
        MaybePublished<float> printed = {})
      : Param(pass, std::move(name), value, range, "", std::move(meaning), printed) {}
  operator float() const { return value_; }
  std::string valueText() const override;
  std::string defaultText() const override;
  std::string publishedText() const override;
  void setDefault() override { value_ = default_; }
  void setPublished() override { value_ = published_->value; }
  std::string set(double number) override;
  std::string set(const std::string& word) override;

 private:
  float value_, default_;
  MaybePublished<float> published_;
};

template <>
class Param<bool> : public ParamBase {
 public:
  Param(Pass* pass, std::string name, bool value, std::string meaning, MaybePublished<bool> printed = {});
  operator bool() const { return value_; }
  std::string valueText() const override;  ///< "on" or "off"
  std::string defaultText() const override;
  std::string publishedText() const override;
  void setDefault() override { value_ = default_; }
  void setPublished() override { value_ = published_->value; }
  std::string set(double number) override;
  std::string set(const std::string& word) override;

 private:
  bool value_, default_;
  MaybePublished<bool> published_;
};

/// The compiler's name of a value: "lobe" for lumivox::Gather::Lobe::lobe; empty for a number without a name.
template <auto kValue>
constexpr std::string_view valueName() {
  constexpr std::string_view function = __PRETTY_FUNCTION__, before = "kValue = ";
  const std::size_t first = function.find(before) + before.size();
  const std::string_view value = function.substr(first, function.find_first_of(";]", first) - first);
  return value.front() == '(' ? std::string_view() : value.substr(value.rfind(':') + 1);
}

class WordParam : public ParamBase {
 public:
  std::string valueText() const override { return choices_[value_]; }
  std::string defaultText() const override { return choices_[default_]; }
  std::string publishedText() const override { return published_ ? choices_[*published_] : std::string(); }
  void setDefault() override { value_ = default_; }
  void setPublished() override { value_ = *published_; }
  std::string set(double number) override;
  std::string set(const std::string& word) override;

 protected:
  WordParam(Pass* pass, std::string name, std::size_t value, std::vector<std::string> words,
            std::string meaning, std::optional<std::size_t> printed);
  /// The words of an enumeration from its value `kFirst` on.
  template <class Word, std::size_t kFirst = 0>
  static std::vector<std::string> wordsOf(std::vector<std::string> before = {}) {
    constexpr std::string_view name = valueName<static_cast<Word>(kFirst)>();
    if constexpr (name.empty()) {
      return before;
    } else {
      before.push_back(wordOf(name));
      return wordsOf<Word, kFirst + 1>(std::move(before));
    }
  }
  static std::string wordOf(std::string_view name);
  std::size_t value_, default_;
  std::optional<std::size_t> published_;
};

/// One word out of a few. The enumeration counts from 0, and texts call its values by their names in snake
/// case, without an underscore at the end, which keeps a word apart from one of C++:
///   enum class Precision { float_, asPublished };  // float, as_published
template <class Word>
class Param : public WordParam {
  static_assert(std::is_enum_v<Word>, "expected an enumeration, int, float or bool");

 public:
  Param(Pass* pass, std::string name, Word value, std::string meaning, MaybePublished<Word> printed = {})
      : WordParam(pass, std::move(name), static_cast<std::size_t>(value), wordsOf<Word>(), std::move(meaning),
                  printed ? std::optional(static_cast<std::size_t>(printed->value)) : std::nullopt) {}
  operator Word() const { return static_cast<Word>(value_); }
};

/// The switch `as_published`. Every pass with a published value has it. A pass declares it itself if its
/// printed form differs in more than parameters; `more` says in what. The pass then reads it.
class PublishedForm : public Param<bool> {
 public:
  explicit PublishedForm(Pass* pass, std::string more = {});
  std::string meaning() const override;  ///< with the words of all parameters that it sets

 private:
  const Pass& pass_;
  std::string more_;
};

}  // namespace lumivox
