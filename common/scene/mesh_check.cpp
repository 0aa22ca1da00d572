#include "common/scene/mesh_check.h"

#include <charconv>
#include <cstdint>
#include <cstring>
#include <optional>

#include "common/scene/error.h"
#include "common/scene/ply_check.h"
#include "common/scene/text_cursor.h"

namespace vislab {
namespace {

[[noreturn]] void fail(const std::string& where, const std::string& what) {
  throw InputError(where + ": " + what);
}

void check_off(std::string_view bytes, const std::string& where) {
  TextCursor cursor(bytes, '#');
  std::optional<std::string_view> token = cursor.next_word();
  if (!token || token->size() < 3 || token->substr(token->size() - 3) != "OFF") {
    fail(where, "an off file begins with OFF");
  }
  const std::optional<std::int64_t> vertices = cursor.next_whole();
  const std::optional<std::int64_t> faces = cursor.next_whole();
  if (!vertices || !faces || *vertices < 0 || *faces < 0) {
    fail(where, "the numbers of vertices and faces must follow OFF");
  }
  cursor.skip_line();  // the number of edges, which some writers leave out
  for (std::int64_t v = 0; v < *vertices; ++v) {
    std::optional<TextCursor> line = cursor.next_line();
    if (!line || !line->next_number() || !line->next_number() || !line->next_number()) {
      fail(where, "vertex " + std::to_string(v) + " is missing or not three numbers; the header " +
                      "promises " + std::to_string(*vertices) + " vertices");
    }
  }
  for (std::int64_t f = 0; f < *faces; ++f) {
    const std::string face = "face " + std::to_string(f);
    std::optional<TextCursor> line = cursor.next_line();
    const std::optional<std::int64_t> corners =
        line ? line->next_whole() : std::optional<std::int64_t>();
    if (!corners || *corners < 1) {
      fail(where, face + " is missing or has no corners; the header promises " +
                      std::to_string(*faces) + " faces");
    }
    for (std::int64_t corner = 0; corner < *corners; ++corner) {
      const std::optional<std::int64_t> index = line->next_whole();
      if (!index)
        fail(where, face + " has fewer than its " + std::to_string(*corners) + " corners");
      if (*index < 0 || *index >= *vertices) {
        fail(where, face + ": vertex index " + std::to_string(*index) +
                        " is out of range; the file has " + std::to_string(*vertices) +
                        " vertices");
      }
    }
  }
}

/// The vertex an obj corner ("7", "7/1", "-2//3") names, from 1; counted back from `defined` if it
/// is negative.
std::optional<std::int64_t> obj_vertex(std::string_view corner, std::int64_t defined) {
  std::int64_t index = 0;
  const char* const end = corner.data() + corner.size();
  const auto [rest, error] = std::from_chars(corner.data(), end, index);
  if (error != std::errc() || (rest != end && *rest != '/')) return std::nullopt;
  return index < 0 ? defined + 1 + index : index;
}

void check_obj(std::string_view bytes, const std::string& where) {
  std::int64_t total = 0;
  TextCursor counting(bytes, '#');
  while (std::optional<TextCursor> line = counting.next_line()) {
    if (line->next_word() == "v") ++total;
  }
  std::int64_t defined = 0;
  std::int64_t faces = 0;
  TextCursor cursor(bytes, '#');
  while (std::optional<TextCursor> line = cursor.next_line()) {
    const std::optional<std::string_view> key = line->next_word();
    if (key == "v") {
      if (!line->next_number() || !line->next_number() || !line->next_number()) {
        fail(where, "vertex " + std::to_string(defined + 1) + " is not three numbers");
      }
      ++defined;
    } else if (key == "f") {
      const std::string face = "face " + std::to_string(++faces);
      int corners = 0;
      while (const std::optional<std::string_view> corner = line->next_word()) {
        if (*corner == "\\") {
          line = cursor.next_line();
          if (!line) break;
          continue;
        }
        const std::optional<std::int64_t> vertex = obj_vertex(*corner, defined);
        if (!vertex) fail(where, face + ": `" + std::string(*corner) + "` is not a corner");
        if (*vertex < 1 || *vertex > total) {
          fail(where, face + ": vertex index " + std::to_string(*vertex) +
                          " is out of range; the file has " + std::to_string(total) + " vertices");
        }
        ++corners;
      }
      if (corners < 3) fail(where, face + " has fewer than three corners");
    }
  }
}

void check_stl(std::string_view bytes, const std::string& where) {
  constexpr std::size_t header = 84;
  constexpr std::size_t record = 50;
  if (bytes.size() >= header) {
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + 80, sizeof count);
    if (bytes.size() == header + record * std::uint64_t{count}) return;
  }
  if (bytes.substr(0, 5) == "solid") {
    if (bytes.find("endsolid") == std::string_view::npos && bytes.find("facet") != bytes.npos) {
      fail(where, "the text ends before `endsolid`");
    }
    if (bytes.find("facet") != std::string_view::npos) return;
  }
  fail(where, "the size of an stl file must be 84 + 50 for each of its triangles");
}

}  // namespace

void check_mesh_bytes(std::string_view bytes, const std::string& format, const std::string& where) {
  if (format == "ply") check_ply(bytes, where);
  if (format == "off") check_off(bytes, where);
  if (format == "obj") check_obj(bytes, where);
  if (format == "stl") check_stl(bytes, where);
}

}  // namespace vislab
