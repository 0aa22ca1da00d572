// The hash that names content everywhere: XXH3, 128 bits, fed field by field so that padding, names
// and addresses never count.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <glm/mat4x3.hpp>
#include <memory>
#include <span>
#include <string>
#include <type_traits>

namespace vislab {

/// Feed values, then take the hash once. Numbers are fed as their little-endian bytes; a list is
/// fed with its length first, so that neighbouring lists cannot be confused.
class ContentHash {
 public:
  ContentHash();
  ~ContentHash();
  ContentHash(const ContentHash&) = delete;
  ContentHash& operator=(const ContentHash&) = delete;

  template <typename Number>
  requires std::is_arithmetic_v<Number>
  void add(Number value) { add_bytes(&value, sizeof value); }
  void add(const std::string& text);
  void add(const glm::dvec3& v);
  void add(const glm::dmat4x3& m);

  /// A list of numbers, or of glm vectors, which hold nothing but their numbers.
  template <typename Element>
  void add_list(std::span<const Element> list) {
    static_assert(std::is_trivially_copyable_v<Element>);
    static_assert(std::is_arithmetic_v<Element> || sizeof(Element) == 3 * sizeof(float) ||
                  sizeof(Element) == 3 * sizeof(double));
    add(static_cast<unsigned long long>(list.size()));
    add_bytes(list.data(), list.size_bytes());
  }

  /// 32 hexadecimal digits.
  std::string hex() const;

 private:
  void add_bytes(const void* data, std::size_t size);

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace vislab
