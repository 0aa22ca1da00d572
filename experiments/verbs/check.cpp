#include <algorithm>
#include <cctype>
#include <cmath>
#include <iostream>
#include <sstream>

#include "experiments/contract/contract.h"
#include "experiments/run/progress.h"
#include "experiments/verbs/table.h"
#include "experiments/verbs/verbs.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

/// "frustum.flat[test=sphere] > none" as part of a file name.
std::string file_name(const std::string& spec) {
  std::string name;
  for (const char c : spec) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '_';
    if (plain) name += c;
    if (!plain && !name.empty() && name.back() != '-') name += '-';
  }
  while (!name.empty() && name.back() == '-') name.pop_back();
  return name;
}

fs::path default_picture(const std::string& culler) {
  return fs::path("out") / "check" / (file_name(culler) + ".png");
}

/// A picture of an earlier failure would be taken for one of now.
void remove_stale_picture(const std::string& culler) {
  std::error_code code;
  fs::remove(default_picture(culler), code);
}

fs::path write_picture(const Witness& witness, const std::string& culler, const fs::path& output) {
  fs::path file = output;
  if (file.empty()) {
    file = default_picture(culler);
    std::error_code code;  // if it cannot be made, writing says so
    fs::create_directories(file.parent_path(), code);
  }
  write_png(file, witness.picture);
  return file;
}

std::string triangle_text(TriangleId triangle) {
  return triangle == none_id ? "the background" : "triangle " + std::to_string(triangle);
}

/// "scene 'a cube', frame 3, pixel 12, 40 from the lower left: triangle 17 of object 2 should be
/// seen, …"
std::string text_of(const Witness& witness) {
  std::ostringstream text;
  text << "scene '" << witness.scene << "', frame " << witness.frame << ", pixel "
       << static_cast<int>(witness.window_px.x) << ", " << static_cast<int>(witness.window_px.y)
       << " from the lower left: " << triangle_text(witness.triangle);
  if (witness.object != none_id) text << " of object " << witness.object;
  text << " should be seen, and " << triangle_text(witness.instead) << " is. ";
  if (witness.wrong_px == 0) {
    text << "No pixel centre of the frame is wrong, only samples between them.";
  } else {
    text << witness.wrong_px
         << (witness.wrong_px == 1 ? " pixel of the frame is" : " pixels of the frame are")
         << " wrong.";
  }
  return text.str();
}

TableValue id_value(std::uint32_t id) {
  return id == none_id ? TableValue() : TableValue(std::uint64_t{id});
}

bool promises(Guarantee guarantee) {
  return guarantee == Guarantee::conservative || guarantee == Guarantee::image_exact;
}

}  // namespace

int check(const Lab& lab, const std::string& culler, const fs::path& output, bool json) {
  const Guarantee guarantee = lab.cullers.make(culler)->info().guarantee;
  std::optional<Witness> witness;
  const std::vector<ContractResult> results = check_contract(lab.cullers, culler, &witness);
  fs::path picture;
  if (witness) {
    picture = write_picture(*witness, culler, output);
  } else {
    remove_stale_picture(culler);
    if (!output.empty()) std::cerr << "vislab: no wrong pixel: no picture written\n";
  }
  Table table({"check", "passed", "message"});
  for (const ContractResult& result : results) {
    table.add({result.check, result.passed, result.message});
  }
  table.print(std::cout, json);
  if (witness && json) {
    Table where({"check", "promised", "scene", "frame", "pixel_x", "pixel_y", "triangle", "object",
                 "instead", "wrong_px", "picture"});
    where.add({"first wrong pixel", promises(guarantee), witness->scene,
               std::uint64_t{witness->frame}, std::floor(witness->window_px.x),
               std::floor(witness->window_px.y), id_value(witness->triangle),
               id_value(witness->object), id_value(witness->instead), witness->wrong_px,
               picture.string()});
    where.print_json(std::cout);
  } else if (witness) {
    std::cout << "\nFirst wrong pixel"
              << (promises(guarantee)
                      ? ""
                      : " (no breach: it is declared " + std::string(to_string(guarantee)) + ")")
              << ": " << text_of(*witness) << "\nPicture: " << picture.string() << '\n';
  } else if (!promises(guarantee) && !json) {
    std::cout << "\nIt is declared " << to_string(guarantee)
              << ", and leaves out nothing visible on the small scenes.\n";
  }
  return std::ranges::all_of(results, &ContractResult::passed) ? 0 : 1;
}

int check_all(const Lab& lab, bool json) {
  Table table({"culler", "guarantee", "passed", "message"});
  Progress progress(false);
  bool all_passed = true;
  double done = 0.0;
  for (const auto& [name, entry] : lab.cullers.entries()) {
    progress.step(name, done++ / static_cast<double>(lab.cullers.entries().size()));
    const std::vector<ContractResult> results = check_contract(lab.cullers, name);
    const auto broken = std::ranges::find(results, false, &ContractResult::passed);
    const bool passed = broken == results.end();
    table.add({name, std::string(to_string(entry.info.guarantee)), passed,
               passed ? "" : "not true that " + broken->check + ": " + broken->message});
    all_passed &= passed;
  }
  progress.finish();
  table.print(std::cout, json);
  return all_passed ? 0 : 1;
}

}  // namespace vislab
