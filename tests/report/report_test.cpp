#include "report/report.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <vector>

#include "common/render/png.h"
#include "common/scene/error.h"
#include "report/method_fields.h"
#include "report/page.h"
#include "report/pdf_pages.h"
#include "report/process.h"
#include "tests/input_error.h"
#include "tests/report/fabricated.h"
#include "tests/temporary_folder.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

const fs::path templates = fs::path(VISLAB_SOURCE_DIR) / "report";

std::string read(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

Image black(int width, int height) {
  return {width, height, std::vector<std::uint8_t>(3 * static_cast<std::size_t>(width * height))};
}

class Report : public testing::Test {
 protected:
  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

ReportInput fabricated_input() {
  ReportInput input;
  BlockSummary block = fabricated_block("made_up_scene");
  block.cells.push_back(fabricated_cell("frustum.flat", 0.29, 0, 4.3));
  block.cells.push_back(fabricated_cell("bold.guess", 0.2, 25'123, 0.4));
  CellSummary failed;
  failed.culler = failed.canonical = "occlusion.slow";
  failed.status = ResultCell::Status::failed;
  failed.reason = "timed out after 300 s";
  failed.frame_ms.median = failed.against_none = Estimate::none();
  block.cells.push_back(failed);
  input.blocks.push_back(block);
  return input;
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size()) {
    text.replace(at, from.size(), to);
  }
}

/// The page as a reader sees it: without markup, and all gaps are single spaces.
std::string words_of(const std::string& html) {
  std::string text;
  bool in_tag = false;
  for (const char c : html) {
    if (c == '<') in_tag = true;
    if (!in_tag) text += c == '\n' ? ' ' : c;
    if (c == '>') in_tag = false;
  }
  for (const char* gap : {"\u202F", "\u00A0", "&nbsp;"}) replace_all(text, gap, " ");
  while (text.find("  ") != std::string::npos) replace_all(text, "  ", " ");
  return text;
}

/// What follows `opening` up to 40 characters, wherever it does not start with "data:" or "#".
std::vector<std::string> outside_references(const std::string& html, const std::string& opening) {
  std::vector<std::string> found;
  for (std::size_t at = 0; (at = html.find(opening, at)) != std::string::npos;) {
    at += opening.size();
    const std::string target = html.substr(at, 40);
    if (!target.starts_with("data:") && !target.starts_with('#')) found.push_back(target);
  }
  return found;
}

TEST_F(Report, PageSheetsAndChartAreWrittenAndSayWhatTheInputSays) {
  write_report(fabricated_input(), templates, folder_ / "out");
  const std::string html = read(folder_ / "out" / "index.html");
  const std::string words = words_of(html);
  EXPECT_NE(words.find("On made_up_scene, frustum.flat saves 71 % of the frame at 0 errors "
                       "(0 of 15,728,640 pixels"),
            std::string::npos);
  EXPECT_NE(words.find("bold.guess takes only 0.200 times as long as drawing everything, but is "
                       "wrong in 25,123 of 15,728,640 pixels"),
            std::string::npos);
  EXPECT_NE(words.find("occlusion.slow failed: timed out after 300 s"), std::string::npos);
  EXPECT_NE(words.find("1,234"), std::string::npos);  // the error floor
  EXPECT_LT(html.find("id=\"the-error-floor\""), html.find("id=\"the-scenes\""));
  EXPECT_TRUE(read(folder_ / "out" / "report.pdf").starts_with("%PDF-"));
  EXPECT_NE(read(folder_ / "out" / "main-chart.svg").find("<svg"), std::string::npos);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "out"), {}), 3);
}

TEST_F(Report, SaysWhereNothingWasDrawnAndWhereBuildsDiffer) {
  ReportInput input = fabricated_input();
  BlockSummary& block = input.blocks[0];
  block.drawn = false;
  block.mixed_context["revision"] = {"aaa", "bbb"};
  for (CellSummary& cell : block.cells) {
    cell.drawn = false;
    cell.image_px = 0;
    cell.against_none = cell.efficiency = Estimate::none();
  }
  write_report(input, templates, folder_);
  const std::string words = words_of(read(folder_ / "index.html"));
  EXPECT_NE(words.find("On made_up_scene, nothing was drawn, so there is no saving to speak of; "
                       "without errors, frustum.flat leaves the least over: 4.30"),
            std::string::npos);
  EXPECT_NE(words.find("Revision: aaa; bbb (mixed within made_up_scene)"), std::string::npos);
  EXPECT_EQ(words.find("saves 71 %"), std::string::npos);
}

TEST_F(Report, SweepsStandInASectionOfTheirOwn) {
  ReportInput input = fabricated_input();
  Sweep sweep;
  sweep.name = "made_up_sweep";
  sweep.failure = "F1";
  sweep.description = "Boxes grow";
  sweep.dial = {"edge", "m", {1, 2}, {"1", "2"}};
  sweep.methods = {{"frustum.flat", {"frustum.flat", "frustum.flat"}, {}}};
  const CellSummary cell = fabricated_cell("frustum.flat", 0.3, 0, 1.0);
  input.sweeps.push_back(
      find_break_points(sweep, [&](std::size_t, const std::string&) { return &cell; }));
  write_report(input, templates, folder_);
  const std::string words = words_of(read(folder_ / "index.html"));
  EXPECT_NE(words.find("Where methods break"), std::string::npos);
  EXPECT_NE(words.find("Boxes grow: edge from 1 m to 2 m"), std::string::npos);
  write_report(fabricated_input(), templates, folder_);
  EXPECT_EQ(words_of(read(folder_ / "index.html")).find("Where methods break"), std::string::npos);
}

TEST_F(Report, MethodsThatAskTheDeviceHaveASectionWithCharts) {
  ReportInput input = fabricated_input();
  for (const char* scene : {"field_10", "field_90"}) {
    for (const char* latency : {"1", "500"}) {
      BlockSummary block = fabricated_block(scene);
      block.device = std::string("modelled[preset=gpu,latency_us=") + latency + "]";
      CellSummary by_frustum = fabricated_cell("frustum.bvh", 0.5, 0, 4.0);
      by_frustum.culls = Culls::outside_frustum;
      block.cells.push_back(by_frustum);
      CellSummary asking = fabricated_cell("occlusion.chcpp", 0.25, 0, 1.0);
      asking.asks_device = true;
      asking.guarantee = Guarantee::image_exact;
      asking.counters = {{"queries", 12.0}};
      block.cells.push_back(asking);
      input.blocks.push_back(block);
    }
  }
  input.hidden_share = [](const BlockSummary& block) {
    return block.scene == "field_10" ? 0.1 : 0.9;
  };
  write_report(input, templates, folder_);
  const std::string words = words_of(read(folder_ / "index.html"));
  EXPECT_NE(words.find("A occlusion.chcpp in 4 of the cells; ties: 0. The largest lead over the "
                       "next best is 2.00 times, over the fastest by the frustum alone 2.00 times"),
            std::string::npos);
  EXPECT_EQ(words.find("What was asked"), std::string::npos);  // the diagram says it
  EXPECT_NE(words.find("Scenes that were run for a diagram of queries only"), std::string::npos);
  EXPECT_EQ(words.find("On field_10"), std::string::npos);  // no section of its own
  EXPECT_NE(words.find("On made_up_scene"), std::string::npos);
  write_report(fabricated_input(), templates, folder_);
  EXPECT_EQ(words_of(read(folder_ / "index.html")).find("Who is fastest"), std::string::npos);
}

TEST_F(Report, ThePageRefersToNothingOutside) {
  write_report(fabricated_input(), templates, folder_);
  const std::string html = read(folder_ / "index.html");
  for (const char* opening : {" src=\"", " href=\"", " poster=\"", " data=\"", "url(", "@import"}) {
    EXPECT_EQ(outside_references(html, opening), std::vector<std::string>{}) << opening;
  }
  EXPECT_NE(html.find("data:image/svg+xml"), std::string::npos);
}

TEST_F(Report, PicturesStandInThePageWithTheirCaptions) {
  ReportInput input = fabricated_input();
  std::vector<std::string> asked;
  input.picture = [&](const BlockSummary&, const CellSummary& cell, const fs::path& file) {
    asked.push_back(cell.culler);
    if (cell.culler == "bold.guess") throw InputError("the scene is gone");
    std::ofstream(file) << "not quite a PNG";
    return std::string("Frame 17 as seen");
  };
  write_report(input, templates, folder_);
  const std::string html = read(folder_ / "index.html");
  EXPECT_EQ(asked, (std::vector<std::string>{"frustum.flat", "bold.guess"}));
  EXPECT_NE(html.find("Frame 17 as seen"), std::string::npos);
  EXPECT_NE(html.find("data:image/png"), std::string::npos);
  EXPECT_NE(words_of(html).find("There is no picture of bold.guess: the scene is gone"),
            std::string::npos);
}

TEST_F(Report, MethodsStandWithTheirDeclarationAndCitations) {
  Registry registry;
  CullerEntry entry;
  entry.info.name = "frustum.flat";
  entry.info.summary = "Leaves out *boxes*.";
  entry.info.cost = "six planes";
  entry.info.limits = "none known";
  entry.info.sources = {"Clark 1976, about models", "Nobody 1976"};
  entry.info.parameters = {ParameterSpec::choice("test", "box", {"box", "sphere"},
                                                 ParameterSpec::Stage::build, "the volume")};
  registry.add(entry);
  ReportInput input = fabricated_input();
  input.cullers = &registry;
  std::vector<Fields> methods = method_fields(input);
  ASSERT_EQ(methods.size(), 1U);
  cite_sources("@article{clark1976,\n title = {x}\n}", methods);
  EXPECT_EQ(methods[0].lists["sources"][0].values["source"],
            "Clark 1976\\, about models [@clark1976]");
  EXPECT_EQ(methods[0].lists["sources"][1].values["source"], "Nobody 1976");
  EXPECT_EQ(methods[0].values["summary"], "Leaves out \\*boxes\\*\\.");
  EXPECT_EQ(methods[0].lists["parameters"].size(), 1U);
}

CullerEntry declared(const std::string& name, const std::string& family) {
  CullerEntry entry;
  entry.info.name = name;
  entry.info.family = family;
  entry.info.summary = "Leaves out what " + name + " leaves out.";
  entry.info.cost = "none to speak of";
  entry.info.limits = "none known";
  return entry;
}

TEST_F(Report, EveryMeasuredFamilyHasAChapterAlsoOneThatTheTemplatesDoNotKnow) {
  Registry registry;
  registry.add(declared("frustum.flat", "frustum"));
  registry.add(declared("novel.way", "novel"));
  registry.add(declared("novel.other_way", "novel"));
  ReportInput input = fabricated_input();
  input.cullers = &registry;
  for (const char* culler : {"novel.way", "frustum.flat > novel.other_way"}) {
    input.blocks[0].cells.push_back(fabricated_cell(culler, 0.4, 0, 3.0));
  }
  write_report(input, templates, folder_);
  const std::string words = words_of(read(folder_ / "index.html"));
  EXPECT_NE(words.find("View-frustum culling"), std::string::npos);
  const std::size_t chapter = words.find("Methods of the family novel On 1 of the 1 scenes");
  ASSERT_NE(chapter, std::string::npos);
  EXPECT_NE(words.find("where novel.way saves 60 % of the frame", chapter), std::string::npos);
  EXPECT_NE(words.find("Leaves out what novel.other_way leaves out.", chapter), std::string::npos);
  EXPECT_NE(words.find("0 of 2", chapter), std::string::npos);  // no errors in either
}

TEST_F(Report, NoTemplateHasAFormulaThatIsNotUnderstood) {
  Registry registry;
  ReportInput input = fabricated_input();
  std::istringstream order(read(templates / "templates" / "families" / "order.txt"));
  for (std::string family; order >> family;) {
    registry.add(declared(family + ".way", family));
    input.blocks[0].cells.push_back(fabricated_cell(family + ".way", 0.4, 0, 3.0));
  }
  input.cullers = &registry;
  write_report(input, templates, folder_);
  const std::string html = read(folder_ / "index.html");
  EXPECT_NE(html.find("<math "), std::string::npos);
  // What pandoc cannot convert it leaves as text of this class, or with its dollars.
  EXPECT_EQ(html.find("class=\"math "), std::string::npos);
  EXPECT_EQ(words_of(html).find("$$"), std::string::npos);
}

TEST_F(Report, NoTemplateHasAControlCharacter) {
  for (const auto& entry : fs::recursive_directory_iterator(templates)) {
    if (!entry.is_regular_file()) continue;
    for (const char c : read(entry.path())) {
      const auto byte = static_cast<unsigned char>(c);
      ASSERT_TRUE(byte >= 0x20 || c == '\n') << entry.path() << ": byte " << int{byte};
    }
  }
}

TEST_F(Report, FiguresOfAFamilyStandInItsChapterAlsoIfOnlyChainsOfItWereMeasured) {
  ReportInput input = fabricated_input();
  CellSummary chain = fabricated_cell("portal.way > depth.way", 0.4, 0, 3.0);
  chain.counters = {{"frames_outside", 0.0}, {"cells_visited", 4.0}, {"portals_clipped", 9.0}};
  input.blocks[0].cells.push_back(chain);
  write_report(input, templates, folder_);
  const std::string words = words_of(read(folder_ / "index.html"));
  const std::size_t nav_end = words.find("Abstract");
  const std::size_t chapter = words.find("Cells and portals", nav_end);
  const std::size_t walks = words.find("Walks from cell to cell", nav_end);
  const std::size_t remember = words.find("What to remember", chapter);
  ASSERT_NE(chapter, std::string::npos);
  EXPECT_LT(chapter, walks);
  EXPECT_LT(walks, remember);
}

TEST_F(Report, OfEachSceneTheRunWithMostMethodsIsShownAndTheOthersHaveARow) {
  ReportInput input = fabricated_input();
  BlockSummary other = fabricated_block("made_up_scene");
  other.path = "other_path";
  other.cells.push_back(fabricated_cell("frustum.bvh", 0.5, 0, 3.0));
  input.blocks.insert(input.blocks.begin(), other);
  int pictures = 0;
  input.picture = [&](const BlockSummary& block, const CellSummary&, const fs::path& file) {
    std::ofstream(file) << "not quite a PNG";
    pictures += block.path == "other_path" ? 1 : 0;
    return std::string("a frame");
  };
  input.missing_cells = [](const BlockSummary& block) {
    return block.path == "other_path"
               ? std::vector<MissingCell>{{"frustum.flat", "nobody measured it"}}
               : std::vector<MissingCell>{};
  };
  write_report(input, templates, folder_);
  const std::string words = words_of(read(folder_ / "index.html"));
  EXPECT_NE(words.find("Other runs on made_up_scene"), std::string::npos);
  EXPECT_NE(words.find("frustum.flat missing, on other_path, osmesa: nobody measured it"),
            std::string::npos);
  EXPECT_EQ(pictures, 0);
}

TEST_F(Report, ThePrintedContentsHavePageNumbersAndTheScreenHasNone) {
  const std::string html =
      "<a href=\"#x\">x</a><nav><a href=\"#one\" id=\"a\">One</a><a "
      "href=\"#two\">Two</a></nav><a href=\"#one\">there</a>";
  EXPECT_EQ(with_page_numbers(html, {{"one", 12}}),
            "<a href=\"#x\">x</a><nav><a href=\"#one\" id=\"a\"><span class=\"page\">12</span>One"
            "</a><a href=\"#two\"><span class=\"page\"></span>Two</a></nav><a href=\"#one\">there"
            "</a>");
  write_report(fabricated_input(), templates, folder_);
  const std::map<std::string, int> pages = named_pages(read(folder_ / "report.pdf"));
  EXPECT_EQ(pages.count("the-error-floor"), 1U);
  EXPECT_LT(pages.at("the-error-floor"), pages.at("the-run"));
  EXPECT_TRUE(named_pages("%PDF-1.4 and nothing else").empty());
  EXPECT_TRUE(named_pages(read(folder_ / "report.pdf").substr(0, 10'000)).empty());
}

TEST_F(Report, ThePageNumbersOfTheContentsAreThoseThatWerePrinted) {
  constexpr int chapters = 12;
  std::string text;
  for (int i = 0; i < chapters; ++i) {
    const std::string n = std::to_string(i);
    write_png(folder_ / ("picture-" + n + ".png"), black(640, 100 + 90 * i));
    std::ofstream(folder_ / ("chart-" + n + ".svg"))
        << "<svg width=\"480\" height=\"" << 640 - 40 * i
        << "\" xmlns=\"http://www.w3.org/2000/svg\"></svg>";
    text +=
        "# Chapter " + n + "\n\n![One](picture-" + n + ".png)\n\n![Two](chart-" + n + ".svg)\n\n";
  }
  std::ofstream(folder_ / "report.md") << text;
  std::ofstream(folder_ / "summary.md") << "In short.\n";
  make_page(templates, folder_);
  const std::map<std::string, int> pages = named_pages(read(folder_ / "report.pdf"));
  EXPECT_GT(pages.at("chapter-11"), chapters / 2);
  const std::string printed = read(folder_ / "print.html");
  for (int i = 0; i < chapters; ++i) {
    const std::string id = "chapter-" + std::to_string(i);
    const std::size_t link = printed.find("<a href=\"#" + id + "\"", printed.find("<nav"));
    const std::string number = "<span class=\"page\">" + std::to_string(pages.at(id)) + "</span>";
    ASSERT_NE(link, std::string::npos);
    const std::size_t open = printed.find('>', link) + 1;
    EXPECT_EQ(printed.substr(open, number.size()), number);
  }
}

TEST_F(Report, BlankPicturesHaveTheSizesOfTheirOwn) {
  write_png(folder_ / "a.png", black(300, 70));
  std::ofstream(folder_ / "b.svg")
      << "<?xml version=\"1.0\"?>\n<svg \n width=\"68\" height=\"44\"\n>"
         "<rect width=\"1\" height=\"2\"/></svg>";
  std::ofstream(folder_ / "c.png") << "not quite a PNG";
  const std::string blank = "data:image/svg+xml,<svg xmlns='http://www.w3.org/2000/svg' ";
  EXPECT_EQ(with_blank_pictures(
                "<img src=\"a.png\"><img src=\"b.svg\" alt=\"b\"><img src=\"c.png\">", folder_),
            "<img src=\"" + blank + "width='300' height='70'/>\"><img src=\"" + blank +
                "width='68' height='44'/>\" alt=\"b\"><img src=\"c.png\">");
}

TEST_F(Report, CodeInTablesMayBreakAfterTheSignsThatJoinNames) {
  EXPECT_EQ(with_breaks_in_tables("<p><code>a.b</code></p><td><code>a.b[c_d=1]</code> x.y</td>"),
            "<p><code>a.b</code></p><td><code>a.<wbr>b[<wbr>c_d=<wbr>1]</code> x.y</td>");
}

TEST_F(Report, TheIntroductionSaysWhereEachRegisteredMethodStands) {
  Registry registry;
  CullerEntry entry = declared("novel.way", "novel");
  entry.info.space = Space::image;
  entry.info.stage = PipelineStage::raster;
  entry.info.guarantee = Guarantee::approximate;
  registry.add(entry);
  ReportInput input = fabricated_input();
  input.cullers = &registry;
  input.kinds_picture = [](const BlockSummary&, const fs::path& file) {
    std::ofstream(file) << "not quite a PNG";
    return KindsPicture{"made_up_scene, orbit, frame 3", 4, 0.0};
  };
  write_report(input, templates, folder_);
  const std::string words = words_of(read(folder_ / "index.html"));
  EXPECT_NE(words.find("novel novel.way image raster objects approximate"), std::string::npos);
  EXPECT_NE(words.find("made_up_scene, orbit, frame 3: why each triangle"), std::string::npos);
  EXPECT_NE(words.find("Only 4 of the five kinds"), std::string::npos);
}

TEST_F(Report, GapsStandWithTheirReasons) {
  ReportInput input = fabricated_input();
  input.missing_cells = [](const BlockSummary& block) {
    return std::vector<MissingCell>{{"frustum.bvh", "nobody measured it on " + block.scene}};
  };
  input.missing_blocks = {{"other_scene, 512x512, osmesa", "it was deleted"}};
  write_report(input, templates, folder_);
  const std::string words = words_of(read(folder_ / "index.html"));
  EXPECT_NE(words.find("frustum.bvh missing: nobody measured it on made_up_scene"),
            std::string::npos);
  EXPECT_NE(words.find("other_scene, 512x512, osmesa: nothing is here of it. it was deleted"),
            std::string::npos);
}

TEST_F(Report, WithoutAnyAnchorTheRestStillStands) {
  ReportInput input = fabricated_input();
  std::erase_if(input.blocks[0].cells, [](const CellSummary& cell) { return cell.anchor; });
  for (CellSummary& cell : input.blocks[0].cells) {
    cell.against_none = cell.efficiency = Estimate::none();
  }
  input.blocks[0].noise = Estimate::none();
  write_report(input, templates, folder_);
  EXPECT_NE(words_of(read(folder_ / "index.html"))
                .find("no method was both judged and timed against drawing everything"),
            std::string::npos);
}

TEST_F(Report, SourcesAreNumberedInTheOrderOfTheText) {
  write_report(fabricated_input(), templates, folder_);
  const std::string html = read(folder_ / "index.html");
  EXPECT_NE(html.find("[1]"), std::string::npos);
  EXPECT_NE(html.find("[2]"), std::string::npos);
  EXPECT_EQ(words_of(html).find("Zachmann 2012"), std::string::npos);
}

TEST_F(Report, TimesOfSeveralMachinesAreNotComparedAndThatIsSaid) {
  ReportInput input = fabricated_input();
  input.blocks[0].machines = {"one", "two"};
  write_report(input, templates, folder_);
  EXPECT_NE(words_of(read(folder_ / "index.html")).find("were measured on 2 machines"),
            std::string::npos);
}

TEST_F(Report, TimesOfSeveralFitsAreNotComparedAndThatIsSaid) {
  ReportInput input = fabricated_input();
  BlockSummary& block = input.blocks[0];
  block.device = "modelled[preset=osmesa]";
  block.device_models = {gpu_preset("gpu").model, gpu_preset("modern").model};
  block.cells.back().device_model = 1;
  write_report(input, templates, folder_);
  const std::string words = words_of(read(folder_ / "index.html"));
  EXPECT_NE(words.find("were measured on 2 fits of the device"), std::string::npos);
  EXPECT_NE(words.find("none fit 1"), std::string::npos);
}

TEST_F(Report, NothingToReportIsAnInputError) {
  EXPECT_THROW(write_report({}, templates, folder_ / "out"), InputError);
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

/// Sets PATH for as long as it lives.
class PathOnly {
 public:
  explicit PathOnly(const fs::path& folder) : before_(std::getenv("PATH")) {
    ::setenv("PATH", folder.c_str(), 1);
  }
  ~PathOnly() { ::setenv("PATH", before_.c_str(), 1); }
  PathOnly(const PathOnly&) = delete;
  PathOnly& operator=(const PathOnly&) = delete;

 private:
  std::string before_;
};

TEST_F(Report, AMissingProgramIsNamedWithItsPackageAndNothingIsWritten) {
  const PathOnly empty(folder_);
  const std::string message =
      input_error([&] { write_report(fabricated_input(), templates, folder_ / "out"); });
  EXPECT_NE(message.find("gnuplot"), std::string::npos) << message;
  EXPECT_NE(message.find("gnuplot-nox"), std::string::npos) << message;
  EXPECT_FALSE(fs::exists(folder_ / "out"));
}

void write_program(const fs::path& file, const std::string& body) {
  std::ofstream(file) << "#!/bin/sh\n" << body << '\n';
  fs::permissions(file, fs::perms::owner_all);
}

TEST_F(Report, AProgramThatFailsLeavesTheOldReportAsItWas) {
  const fs::path out = folder_ / "out";
  fs::create_directories(out);
  std::ofstream(out / "index.html") << "old";
  write_program(folder_ / "gnuplot", "exit 0");
  write_program(folder_ / "pandoc",
                "for a in \"$@\"; do case $a in --output=*) echo >${a#--output=};; esac; done");
  write_program(folder_ / "chromium", "echo 'no display'; exit 3");
  const PathOnly programs(folder_);
  const std::string message =
      input_error([&] { write_report(fabricated_input(), templates, out); });
  EXPECT_NE(message.find("chromium failed while writing the report: no display"), std::string::npos)
      << message;
  EXPECT_EQ(read(out / "index.html"), "old");
  EXPECT_FALSE(fs::exists(out / "report.pdf"));
}

TEST_F(Report, AProgramThatHangsIsEnded) {
  write_program(folder_ / "sleeper", "/bin/sleep 100");
  const PathOnly programs(folder_);
  const std::string message = input_error([&] {
    run_program({"sleeper", "none"}, {}, folder_, std::chrono::seconds(1));
  });
  EXPECT_NE(message.find("did not end within 1 s"), std::string::npos) << message;
}

TEST_F(Report, AFolderThatCannotBeMadeIsAnInputError) {
  std::ofstream(folder_ / "file") << "in the way";
  const std::string message =
      input_error([&] { write_report(fabricated_input(), templates, folder_ / "file" / "out"); });
  EXPECT_NE(message.find("cannot be written"), std::string::npos) << message;
}

}  // namespace
}  // namespace vislab
