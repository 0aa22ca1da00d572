// vislab: the command line of the lab. Reads the call and hands it to a verb (experiments/verbs).
#include <CLI/CLI.hpp>
#include <cstdlib>
#include <exception>
#include <functional>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "algorithms/all_cullers.h"
#include "common/scene/error.h"
#include "experiments/verbs/verbs.h"

namespace {

using namespace vislab;

Lab make_lab() {
  Lab lab;
  register_all_cullers(lab.cullers);
  lab.repository = VISLAB_SOURCE_DIR;
  lab.data = {lab.repository / "data", lab.repository / "data" / "cache"};
  lab.matrices = lab.repository / "experiments" / "matrices";
  lab.sweeps = lab.repository / "experiments" / "stress";
  lab.size_sweeps = lab.repository / "experiments" / "model_size";
  lab.published = lab.repository / "experiments" / "published";
  lab.errata = lab.repository / "experiments" / "errata" / "errata.toml";
  lab.report = lab.repository / "report";
  return lab;
}

/// The verbs and what each does when it is called. `action` is set by the verb that was parsed.
class CommandLine {
 public:
  CommandLine() {
    run_.results = "out/results";
    app_.name("vislab");
    app_.require_subcommand(0, 1);
    app_.get_formatter()->label("SUBCOMMAND", "VERB");
    app_.footer(
        "Exit code: 0 done, 1 something that was checked failed, 2 the call or an input file is "
        "wrong.");
    app_.failure_message([](const CLI::App* app, const CLI::Error& error) {
      std::string called = app->get_name();
      for (const CLI::App* verb : app->get_subcommands()) called += " " + verb->get_name();
      return "vislab: " + std::string(error.what()) + "; see '" + called + " --help'\n";
    });
    add_list();
    add_describe();
    add_plan();
    add_run();
    add_show();
    add_compare();
    add_export();
    add_report();
    add_atlas();
    add_knees();
    add_check();
    add_new_culler();
    add_baseline();
    add_help();
  }

  /// The exit code.
  int run(int argc, char** argv) {
    if (argc > 1 && argv[1][0] != '-') require_verb(argv[1]);
    try {
      app_.parse(argc, argv);
    } catch (const CLI::Success& success) {
      return app_.exit(success);
    } catch (const CLI::ParseError& error) {
      app_.exit(error, std::cout, std::cerr);
      return 2;
    }
    if (!action_) throw InputError("a verb is missing; 'vislab help' names them all");
    return action_();
  }

 private:
  CLI::App* require_verb(const std::string& name) {
    std::vector<std::string> known;
    for (CLI::App* const sub : app_.get_subcommands(nullptr)) {
      if (sub->get_name() == name) return sub;
      known.push_back(sub->get_name());
    }
    throw unknown_name("verb", name, known);
  }
  CLI::App* verb(const std::string& name, const std::string& meaning, std::function<int()> action) {
    CLI::App* const sub = app_.add_subcommand(name, meaning)->group("Verbs");
    sub->callback([this, action = std::move(action)] { action_ = action; });
    return sub;
  }
  void add_json(CLI::App* sub) { sub->add_flag("--json", json_, "one JSON object a line"); }
  void add_results(CLI::App* sub) {
    sub->add_option("--results", run_.results, "folder of results")->capture_default_str();
  }

  void add_list() {
    CLI::App* const sub =
        verb("list", "what there is: cullers, scenes, matrices, metrics or devices",
             [this] { return list(lab_, name_, json_); });
    sub->add_option("what", name_, "cullers, scenes, matrices, metrics or devices")
        ->default_val("cullers");
    add_json(sub);
  }
  void add_describe() {
    CLI::App* const sub =
        verb("describe", "a culler, a scene, a matrix, a sweep, a metric or a device in full",
             [this] { return describe(lab_, name_, json_); });
    sub->add_option("name", name_,
                    "its name; of cullers also with parameters, or a chain: 'a[x=1] > b'")
        ->required();
    add_json(sub);
  }
  void add_plan() {
    CLI::App* const sub =
        verb("plan", "the cells of matrices and sweeps, and which are done, without running them",
             [this] {
               run_.json = json_;
               return plan(lab_, run_);
             });
    sub->add_option("matrix", run_.matrices,
                    "names or files; stress, model_size = all of these sweeps")
        ->required();
    add_results(sub);
    add_json(sub);
  }
  void add_run() {
    CLI::App* const sub =
        verb("run", "measures matrices, sweeps, or one culler on one scene", [this] {
          run_.json = json_;
          if (run_.matrices.empty() == run_.culler.empty() ||
              run_.culler.empty() != run_.scene.empty()) {
            throw InputError("run takes matrices, or --culler and --scene together");
          }
          return vislab::run(lab_, run_);
        });
    sub->add_option("matrix", run_.matrices,
                    "names or files; stress, model_size = all of these sweeps");
    CLI::Option* const culler =
        sub->add_option("--culler", run_.culler, "a culler or a chain: 'a[x=1] > b'");
    sub->add_option("--scene", run_.scene, "name, description, mesh or Quake III world")
        ->needs(culler);
    sub->add_option("--path", run_.path,
                    "name or file of a camera path; the scene's own if not given")
        ->needs(culler);
    sub->add_option("--resolution", run_.resolution, "WIDTHxHEIGHT, pixels")
        ->needs(culler)
        ->capture_default_str();
    sub->add_option("--frames", run_.frames, "0 = as many as the path has")
        ->needs(culler)
        ->check(CLI::Range(0, 100000));
    sub->add_option("--rounds", run_.rounds, "how often the whole path is measured")
        ->needs(culler)
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    sub->add_option("--draw", run_.draw, "a device of 'vislab list devices'")
        ->needs(culler)
        ->capture_default_str();
    sub->add_option("--threads", run_.threads, "0 = as the matrix says; all with --culler")
        ->check(CLI::Range(0, 1024));
    sub->add_option("--filter", run_.filter, "only chains that contain this text");
    sub->add_option("--shard", run_.shard, "i/n: every n-th block, from the i-th");
    sub->add_flag("--force", run_.force, "measure again what is done");
    sub->add_flag("--retry-failed", run_.retry_failed, "measure failed cells again");
    sub->add_flag("--quiet", run_.quiet, "no progress");
    add_results(sub);
    add_json(sub);
  }
  void add_show() {
    CLI::App* const sub = verb(
        "show", "a picture of a frame: a culler's choice, or how much lies one behind the other",
        [this] {
          if (show_.cullers.empty() == show_.depth_complexity.empty()) {
            throw InputError("show takes either --culler or --depth-complexity");
          }
          if (show_.cullers.empty()) return show_depth_complexity(lab_, show_, json_);
          if (!show_.queries.empty()) return show_queries(lab_, show_);
          if (show_.cullers.size() > 1) {
            throw InputError("show takes one --culler, or several with --queries");
          }
          return show(lab_, show_);
        });
    CLI::Option* const culler =
        sub->add_option("--culler", show_.cullers,
                        "seen from the eye and from outside; with --queries as often as wanted")
            ->allow_extra_args(false);
    CLI::Option* const queries =
        sub->add_option("--queries", show_.queries,
                        "what the cullers ask the device: strip (state changes), boxes or timeline "
                        "(on a modelled device)")
            ->needs(culler);
    sub->add_option("--draw", show_.draw, "with --queries: a device, as run takes it")
        ->needs(queries);
    sub->add_flag("--plan", show_.plan,
                  "the scene's cells and portals from above, and which the culler reached")
        ->needs(culler)
        ->excludes(queries);
    sub->add_option("--depth-complexity", show_.depth_complexity,
                    "a heat map of rays, polygons or transparent, and the figures of all three");
    sub->add_option("--scene", show_.scene, "name, description, mesh or Quake III world")
        ->required();
    sub->add_option("--path", show_.path,
                    "name or file of a camera path; the scene's own if not given");
    sub->add_option("--frame", show_.frame, "of the path; the first is 0")
        ->check(CLI::Range(0, std::numeric_limits<int>::max()))
        ->capture_default_str();
    sub->add_option("--resolution", show_.resolution, "WIDTHxHEIGHT, pixels")
        ->capture_default_str();
    sub->add_option("-o,--output", show_.output, "PNG file")->required();
    add_json(sub);
  }
  void add_compare() {
    CLI::App* const sub =
        verb("compare", "is A faster or slower than B, and has it more or fewer errors?",
             [this] { return compare(lab_, name_, other_, run_.results, json_); });
    sub->add_option("a", name_, "a culler or a chain that was measured")->required();
    sub->add_option("b", other_, "what it is compared with")->required();
    add_results(sub);
    add_json(sub);
  }
  void add_export() {
    CLI::App* const sub = verb("export", "all cells with all metrics",
                               [this] { return export_results(lab_, name_, run_.results); });
    sub->add_option("format", name_, "csv or json")->required();
    add_results(sub);
  }
  void add_report() {
    CLI::App* const sub = verb("report", "writes index.html and report.pdf",
                               [this] { return report(lab_, run_.results, report_folder_); });
    sub->add_option("-o,--output", report_folder_, "folder")->capture_default_str();
    add_results(sub);
  }
  void add_atlas() {
    CLI::App* const sub = verb("atlas", "where methods break: the break points of stress sweeps",
                               [this] { return atlas(lab_, run_.results, json_); });
    add_results(sub);
    add_json(sub);
  }
  void add_knees() {
    CLI::App* const sub =
        verb("knees", "how large models have to be: the knees of size sweeps, and the defaults",
             [this] { return knees(lab_, run_.results, knees_file_, json_); });
    sub->add_option("--write", knees_file_, "also writes them to this file, as data/knees.toml");
    add_results(sub);
    add_json(sub);
  }
  void add_check() {
    CLI::App* const sub =
        verb("check", "contract tests on one culler or chain, or on all; or the cells of a scene",
             [this] {
               if (!checked_culler_.empty() && !checked_scene_.empty()) {
                 throw InputError("check takes --culler or --scene, not both");
               }
               if (!checked_scene_.empty()) return check_scene(lab_, checked_scene_, json_);
               if (checked_culler_.empty()) return check_all(lab_, json_);
               return check(lab_, checked_culler_, check_picture_, json_);
             });
    CLI::Option* const culler =
        sub->add_option("--culler", checked_culler_, "does it keep its contract?");
    sub->add_option("--scene", checked_scene_, "do its cells and portals fit together?");
    sub->add_option("-o,--output", check_picture_,
                    "PNG file for the first wrong pixel; out/check/NAME.png if not given")
        ->needs(culler);
    add_json(sub);
  }
  void add_new_culler() {
    CLI::App* const sub = verb("new-culler", "the files of a new culler, from algorithms/skeleton",
                               [this] { return new_culler(lab_, name_); });
    sub->add_option("name", name_, "family.variant; the family may be a new one")->required();
  }
  void add_help() {
    CLI::App* const sub = verb("help", "what there is to call, or how one verb is called", [this] {
      // help() of a program whose verb is known is that of the verb, so the formatter is asked.
      std::cout << (explained_verb_.empty()
                        ? app_.get_formatter()->make_help(&app_, app_.get_name(),
                                                          CLI::AppFormatMode::Normal)
                        : require_verb(explained_verb_)->help(app_.get_name()));
      return 0;
    });
    sub->add_option("verb", explained_verb_, "one of the verbs");
  }
  void add_baseline() {
    CLI::App* const sub =
        verb("baseline", "do cullers answer as committed? sets and counters of the matrix smoke",
             [this] { return baseline(lab_, run_.results, write_baseline_, json_); });
    sub->add_flag("--write", write_baseline_, "write tests/baseline.toml from the results");
    add_results(sub);
    add_json(sub);
  }

  Lab lab_ = make_lab();
  CLI::App app_{
      "vislab: runs visibility algorithms on the same scenes, judges each against rays, and "
      "charts speed against accuracy"};
  std::function<int()> action_;
  std::string name_, other_;
  std::string checked_culler_, checked_scene_;
  std::string explained_verb_;
  std::filesystem::path check_picture_;
  bool write_baseline_ = false;
  bool json_ = false;
  RunCall run_;
  ShowCall show_;
  std::filesystem::path knees_file_;
  std::filesystem::path report_folder_ = "out/report";
};

}  // namespace

int main(int argc, char** argv) {
  try {
    CommandLine command_line;
    const int code = command_line.run(argc, argv);
    if (!std::cout.flush()) throw std::runtime_error("the output could not be written");
    return code;
  } catch (const InputError& error) {
    std::cerr << "vislab: " << error.what() << '\n';
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "vislab: " << error.what() << '\n';
    return 1;
  }
}
