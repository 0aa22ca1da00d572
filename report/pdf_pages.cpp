#include "report/pdf_pages.h"

#include <charconv>
#include <optional>
#include <vector>

namespace vislab {
namespace {

constexpr std::size_t xref_entry = 20;  // bytes, by the format
constexpr std::size_t most_objects = 1U << 24U;

/// The number at the start of the text, after spaces.
std::optional<std::size_t> number_at(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \n\r");
  if (first == std::string_view::npos) return std::nullopt;
  std::size_t number = 0;
  const auto result = std::from_chars(text.data() + first, text.data() + text.size(), number);
  if (result.ec != std::errc{}) return std::nullopt;
  return number;
}

/// What follows `key` in a dictionary; empty if it is not there.
std::string_view after(std::string_view text, std::string_view key) {
  const std::size_t at = text.find(key);
  return at == std::string_view::npos ? std::string_view{} : text.substr(at + key.size());
}

class PdfFile {
 public:
  explicit PdfFile(std::string_view text) : text_(text) { read_table(); }

  /// The object's text up to its end; empty if there is none.
  std::string_view object(std::size_t number) const {
    if (number >= offsets_.size() || offsets_[number] >= text_.size()) return {};
    const std::string_view from = text_.substr(offsets_[number]);
    return from.substr(0, from.find("endobj"));
  }

  std::string_view root() const {
    const std::optional<std::size_t> number = number_at(after(trailer_, "/Root"));
    return number ? object(*number) : std::string_view{};
  }

  /// Appends the numbers of the pages below a node of the tree of pages, in their order.
  void append_pages(std::size_t node, int depth, std::vector<std::size_t>& pages) const {
    const std::string_view text = object(node);
    const std::string_view kids = after(text, "/Kids [");
    if (kids.empty()) {
      if (!text.empty()) pages.push_back(node);
      return;
    }
    if (depth == 0) return;
    std::string_view list = kids.substr(0, kids.find(']'));
    while (const std::optional<std::size_t> kid = number_at(list)) {
      append_pages(*kid, depth - 1, pages);
      list = after(list, " R");
    }
  }

 private:
  void read_table() {
    const std::size_t start = text_.rfind("startxref");
    if (start == std::string_view::npos) return;
    const std::optional<std::size_t> at = number_at(text_.substr(start + 9));
    if (!at || *at >= text_.size() || !text_.substr(*at).starts_with("xref\n0 ")) return;
    const std::string_view table = text_.substr(*at + 7);
    const std::optional<std::size_t> count = number_at(table);
    const std::size_t first = table.find('\n');
    if (!count || *count > most_objects || first == std::string_view::npos) return;
    const std::string_view entries = table.substr(first + 1);
    if (entries.size() < *count * xref_entry) return;
    for (std::size_t i = 0; i < *count; ++i) {
      offsets_.push_back(number_at(entries.substr(i * xref_entry, xref_entry)).value_or(0));
    }
    trailer_ = entries.substr(*count * xref_entry);
  }

  std::string_view text_, trailer_;
  std::vector<std::size_t> offsets_;  // by object
};

}  // namespace

std::map<std::string, int> named_pages(std::string_view pdf) {
  constexpr int deepest = 16;  // of the tree of pages
  const PdfFile file(pdf);
  const std::string_view root = file.root();
  const std::optional<std::size_t> tree = number_at(after(root, "/Pages"));
  const std::optional<std::size_t> names = number_at(after(root, "/Dests"));
  if (!tree || !names) return {};
  std::vector<std::size_t> order;
  file.append_pages(*tree, deepest, order);
  std::map<std::size_t, int> page_of;
  for (std::size_t i = 0; i < order.size(); ++i) page_of[order[i]] = static_cast<int>(i) + 1;
  std::map<std::string, int> pages;
  for (std::string_view rest = after(file.object(*names), "<<"); !rest.empty();) {
    rest = after(rest, "/");  // a name, and its place: "/name [12 0 R /XYZ 0 800 0]"
    const std::size_t open = rest.find(" [");
    if (open == std::string_view::npos) break;
    const std::string name(rest.substr(0, open));
    rest = rest.substr(open + 2);
    const std::optional<std::size_t> page = number_at(rest);
    if (page && page_of.contains(*page)) pages[name] = page_of.at(*page);
    rest = after(rest, "]");
  }
  return pages;
}

}  // namespace vislab
