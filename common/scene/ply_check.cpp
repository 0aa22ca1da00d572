#include "common/scene/ply_check.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <vector>

#include "common/scene/error.h"
#include "common/scene/text_cursor.h"

namespace vislab {
namespace {

enum class Kind { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct Property {
  std::string name;
  Kind kind = Kind::float32;
  std::optional<Kind> count_kind;  // of lists
};

struct Element {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  enum class Format { text, little_endian, big_endian } format = Format::text;
  std::vector<Element> elements;
};

std::optional<Kind> kind_of(std::string_view word) {
  static const std::map<std::string_view, Kind> kinds{
      {"char", Kind::int8},      {"int8", Kind::int8},       {"uchar", Kind::uint8},
      {"uint8", Kind::uint8},    {"short", Kind::int16},     {"int16", Kind::int16},
      {"ushort", Kind::uint16},  {"uint16", Kind::uint16},   {"int", Kind::int32},
      {"int32", Kind::int32},    {"uint", Kind::uint32},     {"uint32", Kind::uint32},
      {"float", Kind::float32},  {"float32", Kind::float32}, {"double", Kind::float64},
      {"float64", Kind::float64}};
  const auto found = kinds.find(word);
  return found == kinds.end() ? std::nullopt : std::optional<Kind>(found->second);
}

std::size_t size_of(Kind kind) {
  switch (kind) {
    case Kind::int8:
    case Kind::uint8:
      return 1;
    case Kind::int16:
    case Kind::uint16:
      return 2;
    case Kind::int32:
    case Kind::uint32:
    case Kind::float32:
      return 4;
    case Kind::float64:
      return 8;
  }
  return 0;
}

/// Reads values of the body one by one; nothing when the file ends or a word is not a number.
class Body {
 public:
  Body(std::string_view bytes, Header::Format format)
      : cursor_(bytes), bytes_(bytes), format_(format) {}

  std::optional<double> next(Kind kind) {
    if (format_ == Header::Format::text) return cursor_.next_number();
    const std::size_t size = size_of(kind);
    if (bytes_.size() < size) return std::nullopt;
    char raw[8];
    std::memcpy(raw, bytes_.data(), size);
    bytes_.remove_prefix(size);
    if (format_ == Header::Format::big_endian) std::reverse(raw, raw + size);
    switch (kind) {
      case Kind::int8:
        return value<std::int8_t>(raw);
      case Kind::uint8:
        return value<std::uint8_t>(raw);
      case Kind::int16:
        return value<std::int16_t>(raw);
      case Kind::uint16:
        return value<std::uint16_t>(raw);
      case Kind::int32:
        return value<std::int32_t>(raw);
      case Kind::uint32:
        return value<std::uint32_t>(raw);
      case Kind::float32:
        return value<float>(raw);
      case Kind::float64:
        return value<double>(raw);
    }
    return std::nullopt;
  }

 private:
  template <typename Number>
  static double value(const char* raw) {
    Number number;
    std::memcpy(&number, raw, sizeof number);
    return static_cast<double>(number);
  }

  TextCursor cursor_;
  std::string_view bytes_;
  Header::Format format_;
};

[[noreturn]] void fail(const std::string& where, const std::string& what) {
  throw InputError(where + ": " + what);
}

Property read_property(TextCursor line, const std::string& where) {
  Property property;
  std::optional<std::string_view> word = line.next_word();
  if (word == "list") {
    word = line.next_word();
    property.count_kind = word ? kind_of(*word) : std::nullopt;
    if (!property.count_kind) fail(where, "a list property without a known count type");
    word = line.next_word();
  }
  const std::optional<Kind> kind = word ? kind_of(*word) : std::nullopt;
  const std::optional<std::string_view> name = line.next_word();
  if (!kind || !name) fail(where, "a property without a known type and a name");
  property.kind = *kind;
  property.name = *name;
  return property;
}

/// Reads the header and leaves `bytes` at the body.
Header read_header(std::string_view& bytes, const std::string& where) {
  Header header;
  bool has_format = false;
  bool first = true;
  while (true) {
    const std::size_t end = bytes.find('\n');
    if (end == std::string_view::npos) fail(where, "the ply header ends too early");
    TextCursor line(bytes.substr(0, end));
    bytes.remove_prefix(end + 1);
    const std::optional<std::string_view> key = line.next_word();
    if (first && key != "ply") fail(where, "a ply file begins with the line ply");
    first = false;
    if (key == "format") {
      const std::optional<std::string_view> format = line.next_word();
      if (format == "binary_little_endian") {
        header.format = Header::Format::little_endian;
      } else if (format == "binary_big_endian") {
        header.format = Header::Format::big_endian;
      } else if (format != "ascii") {
        fail(where, "the ply format must be ascii, binary_little_endian or binary_big_endian");
      }
      has_format = true;
    } else if (key == "element") {
      const std::optional<std::string_view> name = line.next_word();
      const std::optional<std::int64_t> count = line.next_whole();
      if (!name || !count || *count < 0) fail(where, "an element without a name and a count");
      header.elements.push_back({std::string(*name), *count, {}});
    } else if (key == "property") {
      if (header.elements.empty()) fail(where, "a property before the first element");
      header.elements.back().properties.push_back(read_property(line, where));
    } else if (key == "end_header") {
      if (!has_format) fail(where, "the ply header names no format");
      return header;
    }
  }
}

}  // namespace

void check_ply(std::string_view bytes, const std::string& where) {
  const Header header = read_header(bytes, where);
  Body body(bytes, header.format);
  std::int64_t vertices = 0;
  for (const Element& element : header.elements) {
    if (element.name == "vertex") vertices = element.count;
  }
  for (const Element& element : header.elements) {
    if (element.properties.empty()) continue;
    for (std::int64_t i = 0; i < element.count; ++i) {
      const auto missing = [&]() {
        fail(where, element.name + " " + std::to_string(i) +
                        " is missing or not a number; the header promises " +
                        std::to_string(element.count));
      };
      for (const Property& property : element.properties) {
        double count = 1.0;
        if (property.count_kind) {
          const std::optional<double> given = body.next(*property.count_kind);
          if (!given || !(*given >= 0.0)) missing();
          count = given.value_or(0.0);
        }
        const bool indices = element.name == "face" && property.count_kind &&
                             (property.name == "vertex_indices" || property.name == "vertex_index");
        for (double k = 0.0; k < count; k += 1.0) {
          const std::optional<double> value = body.next(property.kind);
          if (!value || (indices && std::isnan(*value))) missing();
          if (indices && !(*value >= 0.0 && *value < static_cast<double>(vertices))) {
            fail(where,
                 "face " + std::to_string(i) + ": vertex index " +
                     std::to_string(static_cast<std::int64_t>(std::clamp(*value, -1e15, 1e15))) +
                     " is out of range; the file has " + std::to_string(vertices) + " vertices");
          }
        }
      }
    }
  }
}

}  // namespace vislab
