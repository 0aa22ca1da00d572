// What the verbs of the program do, apart from reading the command line. Each returns the exit
// code: 0 done, 1 something checked failed; wrong input throws InputError (exit code 2).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/culler/registry.h"
#include "common/scene/library.h"

namespace vislab {

/// Where the lab's own files are, and all cullers.
struct Lab {
  Registry cullers;
  DataFolders data;
  std::filesystem::path repository;
  std::filesystem::path matrices;
  std::filesystem::path sweeps;       // experiments/stress
  std::filesystem::path size_sweeps;  // experiments/model_size
  std::filesystem::path published;    // figures of the sources
  std::filesystem::path errata;       // the file of their errata
  std::filesystem::path report;       // templates
};

/// `what` is cullers, scenes, matrices, metrics or devices.
int list(const Lab& lab, const std::string& what, bool json);
/// `name` is a culler, a chain, a scene, a matrix, a sweep, a metric or a device.
int describe(const Lab& lab, const std::string& name, bool json);

struct RunCall {
  // Or sweeps; "stress" stands for all stress sweeps, "model_size" for all size sweeps.
  std::vector<std::string> matrices;
  // Instead of matrices: one culler on one scene.
  std::string culler, scene, path;
  std::string resolution = "512x512";
  int frames = 0;  // 0 = as many as the path has
  int rounds = 5;
  std::string draw = "osmesa";  // a device, as parse_device takes it
  int threads = 0;              // 0 = as the matrix says, or all cores
  std::string filter;
  std::filesystem::path results;
  std::string shard;  // "i/n"
  bool force = false, retry_failed = false, json = false, quiet = false;
};
int plan(const Lab& lab, const RunCall& call);
int run(const Lab& lab, const RunCall& call);

struct ShowCall {
  std::vector<std::string> cullers;  // one, or several for a picture of queries
  std::string scene, path;
  std::string resolution = "512x512";
  int frame = 0;
  bool plan = false;  // of cells and portals, instead of the views from the eye and from outside
  std::filesystem::path output;
  std::string depth_complexity;     // instead of a culler: rays, polygons or transparent
  std::string queries;              // with cullers: strip, boxes or timeline
  std::optional<std::string> draw;  // with queries: a device; none: one that suits the picture
};
int show(const Lab& lab, const ShowCall& call);
/// A heat map of a frame by that definition of depth complexity; prints the figures of all.
int show_depth_complexity(const Lab& lab, const ShowCall& call, bool json);
/// A picture of what cullers ask the device in a frame.
int show_queries(const Lab& lab, const ShowCall& call);
/// The index of a frame. Throws InputError if the path has no such frame.
std::size_t require_frame(const Path& path, int frame);

/// Two chains in every block of the results that has both, then over all blocks of each device: is
/// `a` faster or slower (ratio of frame_ms, paired by round, with its 95 % interval;
/// undecided if that reaches 1, or what "none" against itself shows), and has it more or fewer
/// undisputed errors? Throws InputError that says what to run if no block has both.
int compare(const Lab& lab, const std::string& a, const std::string& b,
            const std::filesystem::path& results, bool json);
/// All cells with all metrics; `format` is csv or json.
int export_results(const Lab& lab, const std::string& format, const std::filesystem::path& results);
int report(const Lab& lab, const std::filesystem::path& results,
           const std::filesystem::path& output);
/// The knees of all size sweeps that were run: the smallest models that are nearly as efficient as
/// the best. Written to `written` as data/knees.toml has them, unless that is empty.
int knees(const Lab& lab, const std::filesystem::path& results,
          const std::filesystem::path& written, bool json);
/// The break points of all stress sweeps that were run. 1 if a promise is broken, or a method
/// breaks that never should.
int atlas(const Lab& lab, const std::filesystem::path& results, bool json);
/// The contract tests on one culler or chain, and its first wrong pixel, if there is one, as a
/// picture in `output` (empty: out/check/NAME.png). 1 if a rule is broken.
int check(const Lab& lab, const std::string& culler, const std::filesystem::path& output,
          bool json);
/// The contract tests on every culler, one row each. 1 if any breaks a rule.
int check_all(const Lab& lab, bool json);
/// The files of a new culler, family.variant, in the checkout that the present folder lies in: all
/// of them or none. Throws InputError for names that are taken or cannot be, and outside of a
/// checkout.
int new_culler(const Lab& lab, const std::string& name);
/// The answers of matrix smoke against the committed ones: 1 if any differ. `write` commits those
/// in `results` instead.
int baseline(const Lab& lab, const std::filesystem::path& results, bool write, bool json);
/// Do the cells and portals of a scene fit together, and do surfaces close them? 1 if not.
int check_scene(const Lab& lab, const std::string& scene, bool json);

}  // namespace vislab
