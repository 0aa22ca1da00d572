// Makes the files of a new culler from algorithms/skeleton, in the checkout that it is called in.
#include <algorithm>
#include <cctype>
#include <iostream>
#include <optional>
#include <set>
#include <vector>

#include "common/scene/error.h"
#include "experiments/results/files.h"
#include "experiments/verbs/verbs.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

struct CullerName {
  std::string family, variant;
};

/// Lower case; no underscore in a family, so that `a_b` + `c` and `a` + `b_c` are no one function.
/// Two underscores in a row are C++'s own, and one at the end belongs to members.
bool is_word(const std::string& text, bool underscores) {
  if (text.empty() || std::islower(static_cast<unsigned char>(text.front())) == 0) return false;
  if (text.ends_with('_') || text.find("__") != std::string::npos) return false;
  return std::ranges::all_of(text, [&](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return std::islower(byte) != 0 || std::isdigit(byte) != 0 || (underscores && c == '_');
  });
}

CullerName parse_name(const std::string& name) {
  const auto dot = name.find('.');
  const CullerName parts{name.substr(0, dot), dot == std::string::npos ? "" : name.substr(dot + 1)};
  if (!is_word(parts.family, false) || !is_word(parts.variant, true) ||
      parts.family == parts.variant) {
    throw InputError(
        "'" + name +
        "' cannot be a culler's name; right is family.variant, of lower-case letters "
        "and digits (the variant also of single _ between them), such as frustum.two_step");
  }
  return parts;
}

/// The checkout that the present folder lies in.
fs::path find_checkout() {
  const fs::path here = fs::current_path();
  for (fs::path folder = here;; folder = folder.parent_path()) {
    std::error_code code;
    if (fs::is_regular_file(folder / "algorithms" / "skeleton" / "example.cpp", code) &&
        fs::is_regular_file(folder / "cmake" / "Vislab.cmake", code)) {
      return folder;
    }
    if (folder == folder.parent_path()) break;
  }
  throw InputError(here.string() +
                   " is not in a checkout of vislab (no algorithms/skeleton/example.cpp above it); "
                   "change to one first");
}

/// The text with every `from` replaced; the skeleton must have it.
std::string replaced(std::string text, const std::string& from, const std::string& to) {
  std::size_t at = text.find(from);
  if (at == std::string::npos) {
    throw InputError("algorithms/skeleton/example.cpp does not hold '" + from +
                     "' any more; restore it, or copy it by hand");
  }
  for (; at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

/// "frustum", "two_step": "FrustumTwoStep".
std::string class_name(const CullerName& name) {
  std::string result;
  bool upper = true;
  for (const char c : name.family + "_" + name.variant) {
    if (c != '_') {
      result += upper ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
    }
    upper = c == '_';
  }
  return result;
}

std::string source_of(const std::string& skeleton, const CullerName& name) {
  std::string text = replaced(skeleton, ": a culler to copy. It leaves out", ": leaves out");
  text = replaced(text, ": an example to copy.", ".");
  text = replaced(text, "skeleton.example", name.family + "." + name.variant);
  text = replaced(text, "skeleton_example", name.family + "_" + name.variant);
  text = replaced(text, "\"skeleton\"", "\"" + name.family + "\"");
  // With both words and "Culler" in it, no name of the lab is hidden.
  text = replaced(text, "class Example ", "class " + class_name(name) + "Culler ");
  text = replaced(text, "explicit Example(", "explicit " + class_name(name) + "Culler(");
  return replaced(text, "make_unique<Example>", "make_unique<" + class_name(name) + "Culler>");
}

bool is_name_part(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Where the arguments of a call `function(name …` begin, after the name.
std::optional<std::size_t> find_call(const std::string& text, const std::string& function,
                                     const std::string& name) {
  const std::string start = function + "(" + name;
  for (std::size_t at = text.find(start); at != std::string::npos; at = text.find(start, at + 1)) {
    const std::size_t end = at + start.size();
    if (end < text.size() && !is_name_part(text[end])) return end;
  }
  return std::nullopt;
}

/// The list with one more culler after its last: in the call that begins before `at`.
std::string with_culler(std::string text, std::size_t at, const std::string& variant,
                        const fs::path& file) {
  at = text.find("CULLERS", at);
  std::size_t end = std::string::npos;  // of the last name
  std::string gap = " ";
  if (at != std::string::npos) {
    const std::set<std::string> keywords{"SOURCES", "LIBRARIES", "USES", "USES_TRUTH"};
    at += std::string("CULLERS").size();
    for (;;) {
      const std::size_t word = text.find_first_not_of(" \t\n", at);
      if (word == std::string::npos || text[word] == ')') break;
      const std::size_t after = text.find_first_of(" \t\n)", word);
      if (after == std::string::npos || keywords.contains(text.substr(word, after - word))) break;
      gap = text.substr(at, word - at);
      end = after;
      at = after;
    }
  }
  if (end == std::string::npos) {
    throw InputError(file.string() + ": the list after CULLERS cannot be read; add " + variant +
                     " to it by hand");
  }
  return text.insert(end, gap + variant);
}

/// The folder of a family that exists.
std::optional<fs::path> folder_of(const fs::path& algorithms, const std::string& family) {
  for (const auto& entry : fs::directory_iterator(algorithms)) {
    const fs::path file = entry.path() / "CMakeLists.txt";
    if (fs::is_regular_file(file) &&
        find_call(read_file(file), "vislab_add_culler_family", family)) {
      return entry.path();
    }
  }
  return std::nullopt;
}

/// A family is a library of the build: its name must not be another library's.
void require_free_library(const fs::path& checkout, const std::string& family) {
  bool taken = std::set<std::string>{"options", "cullers", "precompiled"}.contains(family);
  for (const char* part : {"common", "experiments", "report"}) {
    for (const auto& entry : fs::recursive_directory_iterator(checkout / part)) {
      if (taken || entry.path().filename() != "CMakeLists.txt") continue;
      taken = find_call(read_file(entry.path()), "vislab_add_library", family).has_value();
    }
  }
  if (taken) {
    throw InputError("'" + family +
                     "' is the name of a library of the lab; call the family otherwise");
  }
}

void add_to_family(const fs::path& folder, const CullerName& name, const std::string& source) {
  const fs::path file = folder / (name.variant + ".cpp");
  if (fs::exists(file)) throw InputError(file.string() + " exists already; choose another name");
  const fs::path list = folder / "CMakeLists.txt";
  const std::string text = read_file(list);
  const std::size_t call = *find_call(text, "vislab_add_culler_family", name.family);
  const std::string longer = with_culler(text, call, name.variant, list);
  write_file(file, source);
  try {
    write_file(list, longer);
  } catch (const InputError&) {
    fs::remove(file);
    throw;
  }
  std::cout << "wrote " << file.string() << "\nadded it to " << list.string() << '\n';
}

void add_family(const fs::path& algorithms, const CullerName& name, const std::string& source) {
  const fs::path folder = algorithms / name.family;
  if (fs::exists(folder)) {
    throw InputError(folder.string() + " exists already; choose another name");
  }
  const fs::path list = algorithms / "CMakeLists.txt";
  std::string text = read_file(list);
  const std::size_t at = text.find("add_subdirectory(skeleton)");
  if (at == std::string::npos) {
    throw InputError(list.string() +
                     " does not name the folder skeleton, before which families are added");
  }
  text.insert(at, "add_subdirectory(" + name.family + ")\n");
  const fs::path unfinished = folder.string() + ".tmp";
  std::error_code code;
  try {
    fs::create_directories(unfinished);
    write_file(unfinished / (name.variant + ".cpp"), source);
    write_file(unfinished / "CMakeLists.txt",
               "vislab_add_culler_family(" + name.family + " CULLERS " + name.variant + ")\n");
    fs::rename(unfinished, folder);
    write_file(list, text);
  } catch (const std::exception& error) {
    fs::remove_all(unfinished, code);
    fs::remove_all(folder, code);
    throw InputError(error.what());
  }
  std::cout << "wrote " << (folder / (name.variant + ".cpp")).string() << "\nwrote "
            << (folder / "CMakeLists.txt").string() << "\nadded the folder to " << list.string()
            << '\n';
}

}  // namespace

int new_culler(const Lab& lab, const std::string& name) {
  const CullerName parts = parse_name(name);
  if (lab.cullers.entries().contains(parts.family)) {
    throw InputError("'" + parts.family +
                     "' is a culler that is called by that name alone; call the family otherwise");
  }
  const fs::path checkout = find_checkout();
  const fs::path algorithms = checkout / "algorithms";
  const std::string source = source_of(read_file(algorithms / "skeleton" / "example.cpp"), parts);
  if (const std::optional<fs::path> folder = folder_of(algorithms, parts.family)) {
    add_to_family(*folder, parts, source);
  } else {
    require_free_library(checkout, parts.family);
    add_family(algorithms, parts, source);
  }
  std::cout << "next: ./lab build && build/release/vislab check --culler " << name << '\n';
  return 0;
}

}  // namespace vislab
