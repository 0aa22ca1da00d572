#include "report/template.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "common/scene/error.h"

namespace vislab {
namespace {

using Scopes = std::vector<const Fields*>;  // innermost last

class Filler {
 public:
  Filler(std::string_view text, const std::string& where) : text_(text), where_(where) {}

  std::string fill(const Fields& fields) {
    std::string result;
    Scopes scopes{&fields};
    fill_until("", scopes, &result);
    return result;
  }

 private:
  struct Tag {
    char kind = ' ';  // '#', '^', '/', or ' ' for a value
    std::string_view name;
    std::size_t begin = 0, end = 0;  // of the tag in the text
  };

  [[noreturn]] void fail(std::size_t at, const std::string& what) const {
    const auto line = 1 + std::ranges::count(text_.substr(0, at), '\n');
    throw InputError(where_ + ":" + std::to_string(line) + ": " + what);
  }

  /// The next tag from `at_` on; a section's tag that stands alone takes its line with it.
  bool next_tag(Tag& tag) const {
    tag.begin = text_.find("{{", at_);
    if (tag.begin == std::string_view::npos) return false;
    const std::size_t close = text_.find("}}", tag.begin);
    if (close == std::string_view::npos) fail(tag.begin, "'{{' without '}}'");
    tag.name = text_.substr(tag.begin + 2, close - tag.begin - 2);
    tag.end = close + 2;
    tag.kind = ' ';
    if (!tag.name.empty() && std::string_view("#^/").find(tag.name.front()) != std::string::npos) {
      tag.kind = tag.name.front();
      tag.name.remove_prefix(1);
      const bool starts_line = tag.begin == 0 || text_[tag.begin - 1] == '\n';
      if (starts_line && tag.end < text_.size() && text_[tag.end] == '\n') ++tag.end;
    }
    return true;
  }

  /// Fills from `at_` to the end of section `section` ("" is the whole text). Without `result` the
  /// text is skipped.
  void fill_until(std::string_view section, Scopes& scopes, std::string* result) {
    const std::size_t start = at_;
    Tag tag;
    while (next_tag(tag)) {
      if (result != nullptr) result->append(text_.substr(at_, tag.begin - at_));
      at_ = tag.end;
      if (tag.kind == '/') {
        if (tag.name == section && !section.empty()) return;
        fail(tag.begin, "'{{/" + std::string(tag.name) + "}}' does not end the section '" +
                            std::string(section) + "'");
      }
      if (tag.kind != ' ') {
        fill_section(tag, scopes, result);
      } else if (result != nullptr) {
        result->append(value(tag, scopes));
      }
    }
    if (!section.empty()) fail(start, "section '" + std::string(section) + "' has no end");
    if (result != nullptr) result->append(text_.substr(at_));
  }

  void fill_section(const Tag& tag, Scopes& scopes, std::string* result) {
    const std::size_t start = at_;
    fill_until(tag.name, scopes, nullptr);
    const std::size_t end = at_;
    if (result == nullptr) return;
    const std::vector<Fields>& entries = list(tag, scopes);
    const auto repeat = [&](const Fields& entry) {
      at_ = start;
      scopes.push_back(&entry);
      fill_until(tag.name, scopes, result);
      scopes.pop_back();
    };
    if (tag.kind == '#') {
      for (const Fields& entry : entries) repeat(entry);
    } else if (entries.empty()) {
      repeat(Fields{});
    }
    at_ = end;
  }

  const std::string& value(const Tag& tag, const Scopes& scopes) const {
    for (auto scope = scopes.rbegin(); scope != scopes.rend(); ++scope) {
      const auto found = (*scope)->values.find(tag.name);
      if (found != (*scope)->values.end()) return found->second;
    }
    fail(tag.begin, "there is no value '" + std::string(tag.name) + "'");
  }

  const std::vector<Fields>& list(const Tag& tag, const Scopes& scopes) const {
    for (auto scope = scopes.rbegin(); scope != scopes.rend(); ++scope) {
      const auto found = (*scope)->lists.find(tag.name);
      if (found != (*scope)->lists.end()) return found->second;
    }
    fail(tag.begin, "there is no list '" + std::string(tag.name) + "'");
  }

  std::string_view text_;
  const std::string& where_;
  std::size_t at_ = 0;
};

}  // namespace

std::string fill_template(std::string_view text, const Fields& fields, const std::string& where) {
  return Filler(text, where).fill(fields);
}

std::string read_template(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError("the report's template " + file.string() + " cannot be read");
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace vislab
