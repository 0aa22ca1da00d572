// Reads words and numbers out of text, without copies.
#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <string_view>

namespace vislab {

/// A position in a text that must outlive the cursor. What follows `comment` on a line is skipped;
/// '\0' means that there are no comments.
class TextCursor {
 public:
  explicit TextCursor(std::string_view text, char comment = '\0')
      : text_(text), comment_(comment) {}

  /// The next word, separated by white space; nothing at the end.
  std::optional<std::string_view> next_word() {
    skip_space();
    std::size_t size = 0;
    while (size < text_.size() && !is_space(text_[size]) && !is_comment(text_[size])) ++size;
    if (size == 0) return std::nullopt;
    const std::string_view word = text_.substr(0, size);
    text_.remove_prefix(size);
    return word;
  }

  /// The next word as a whole number; nothing if it is none.
  std::optional<std::int64_t> next_whole() { return number<std::int64_t>(next_word()); }

  /// The next word as a number (nan and inf are numbers); nothing if it is none.
  std::optional<double> next_number() { return number<double>(next_word()); }

  /// The next line that is neither blank nor a comment, as a cursor of its own; nothing at the end.
  std::optional<TextCursor> next_line() {
    skip_space();
    if (text_.empty()) return std::nullopt;
    const TextCursor line(text_.substr(0, text_.find('\n')), comment_);
    skip_line();
    return line;
  }

  /// Goes on after the next line break.
  void skip_line() {
    const std::size_t end = text_.find('\n');
    text_.remove_prefix(end == std::string_view::npos ? text_.size() : end + 1);
  }

  std::string_view rest() const { return text_; }

 private:
  static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
  bool is_comment(char c) const { return c == comment_ && comment_ != '\0'; }

  void skip_space() {
    while (!text_.empty()) {
      if (is_space(text_.front())) {
        text_.remove_prefix(1);
      } else if (is_comment(text_.front())) {
        skip_line();
      } else {
        return;
      }
    }
  }

  template <typename Number>
  static std::optional<Number> number(std::optional<std::string_view> word) {
    if (!word) return std::nullopt;
    if (word->size() > 1 && word->front() == '+') word->remove_prefix(1);
    Number value{};
    const char* const end = word->data() + word->size();
    const auto [rest, error] = std::from_chars(word->data(), end, value);
    // A number too small or large for double is still a number of the text.
    const bool whole = rest == end && error != std::errc::invalid_argument;
    return whole ? std::optional<Number>(value) : std::nullopt;
  }

  std::string_view text_;
  char comment_;
};

}  // namespace vislab
