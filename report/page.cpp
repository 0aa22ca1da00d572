#include "report/page.h"

#include <chrono>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>

#include "common/scene/error.h"
#include "report/pdf_pages.h"
#include "report/process.h"

namespace vislab {
namespace {

namespace fs = std::filesystem;

const Program pandoc{"pandoc", "pandoc"};
const Program chromium{"chromium", "chromium"};
/// Many times as long as either takes for the largest report on a quiet machine.
constexpr std::chrono::seconds time_limit{600};

std::string read_file(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw InputError("the report's file " + file.string() + " cannot be read");
  return {std::istreambuf_iterator<char>(stream), {}};
}

void write_file(const fs::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw InputError(file.string() + " cannot be written");
}

/// RFC 4648.
std::string base64(std::string_view bytes) {
  constexpr const char* letters =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      three <<= 8U;
      if (i + k < bytes.size()) three |= static_cast<unsigned char>(bytes[i + k]);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      const bool is_padding = i + k > bytes.size();
      text += is_padding ? '=' : letters[(three >> (18U - 6U * k)) & 63U];
    }
  }
  return text;
}

struct PictureSize {
  std::string width, height;  // pixels
};

/// Of a PNG by its first chunk, of an SVG by its outermost element; none if it has none.
std::optional<PictureSize> picture_size(const std::string& bytes, const std::string& name) {
  if (name.ends_with(".svg")) {
    const auto attribute = [&](const std::string& start) {
      const std::size_t at = bytes.find(start, bytes.find("<svg"));
      if (at == std::string::npos) return std::string();
      const std::size_t from = at + start.size();
      return bytes.substr(from, bytes.find('"', from) - from);
    };
    const PictureSize size{attribute(" width=\""), attribute(" height=\"")};
    return size.width.empty() || size.height.empty() ? std::nullopt : std::optional(size);
  }
  constexpr std::size_t first_chunk = 16;
  if (bytes.size() < first_chunk + 8) return std::nullopt;
  const auto number = [&](std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = at; i < at + 4; ++i) {
      value = value << 8U | static_cast<unsigned char>(bytes[i]);
    }
    return std::to_string(value);
  };
  return PictureSize{number(first_chunk), number(first_chunk + 4)};
}

/// The page with other sources of its pictures.
std::string with_sources(const std::string& html,
                         const std::function<std::string(const std::string& name)>& source_of) {
  constexpr std::string_view image = "<img src=\"";
  std::string result;
  std::size_t at = 0;
  for (std::size_t next = 0; (next = html.find(image, at)) != std::string::npos;) {
    const std::size_t from = next + image.size();
    const std::size_t to = html.find('"', from);
    result += html.substr(at, from - at) + source_of(html.substr(from, to - from));
    at = to;
  }
  return result + html.substr(at);
}

std::string write_page(const fs::path& templates, const fs::path& work) {
  const fs::path absolute = fs::absolute(templates);
  run_program(pandoc,
              {"summary.md", "--from=markdown-implicit_header_references", "--to=html5",
               "--columns=10000", "--output=summary.html"},
              work, time_limit);
  write_file(work / "style.html", "<style>\n" + read_file(absolute / "style.css") + "</style>\n");
  run_program(pandoc,
              {"report.md", "--from=markdown-implicit_header_references", "--to=html5",
               "--metadata-file=" + (absolute / "page.yaml").string(),
               "--template=" + (absolute / "page.html").string(),
               "--bibliography=" + (absolute / "bibliography.bib").string(),
               "--csl=" + (absolute / "numbered.csl").string(), "--citeproc", "--mathml",
               "--standalone", "--toc", "--toc-depth=2", "--number-sections",
               "--include-in-header=style.html", "--include-before-body=summary.html",
               // Tables keep the widths that their content asks for.
               "--columns=10000", "--output=pandoc.html"},
              work, time_limit);
  return with_breaks_in_tables(read_file(work / "pandoc.html"));
}

enum class Printed { draft, final };

/// A draft only tells which page is where: it has no outline and nothing for screen readers, which
/// take half of the time.
void print_page(const fs::path& work, Printed printed) {
  run_program(
      chromium,
      {"--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
       "--disable-extensions", "--disable-background-networking",
       "--user-data-dir=" + (work / "browser").string(), "--no-pdf-header-footer",
       printed == Printed::draft ? "--disable-pdf-tagging" : "--generate-pdf-document-outline",
       "--print-to-pdf=" + (work / "report.pdf").string(),
       "file://" + (work / "print.html").string()},
      work, time_limit);
  if (!fs::exists(work / "report.pdf")) {
    throw InputError("chromium ended without an error but printed no report.pdf");
  }
}

}  // namespace

std::string with_page_numbers(const std::string& html, const std::map<std::string, int>& pages) {
  constexpr std::string_view link = "<a href=\"#";
  const std::size_t begin = html.find("<nav");
  const std::size_t end = html.find("</nav>", begin);
  if (end == std::string::npos) return html;
  std::string result = html.substr(0, begin);
  std::size_t at = begin;
  for (std::size_t next = 0; (next = html.find(link, at)) < end;) {
    const std::size_t id = next + link.size();
    const std::size_t open = html.find('>', id) + 1;
    const auto page = pages.find(html.substr(id, html.find('"', id) - id));
    result += html.substr(at, open - at) + "<span class=\"page\">" +
              (page == pages.end() ? "" : std::to_string(page->second)) + "</span>";
    at = open;
  }
  return result + html.substr(at);
}

std::string with_breaks_in_tables(const std::string& html) {
  constexpr std::string_view begin = "<code>";
  std::string result;
  result.reserve(html.size() + html.size() / 16);
  std::size_t at = 0;
  for (std::size_t cell = 0; (cell = html.find("<td", at)) != std::string::npos;) {
    const std::size_t end = html.find("</td>", cell);
    for (std::size_t code = 0; (code = html.find(begin, cell)) < end; cell = at) {
      const std::size_t from = code + begin.size();
      const std::size_t to = html.find("</code>", from);
      result += html.substr(at, from - at);
      for (std::size_t i = from; i < to; ++i) {
        result += html[i];
        const bool is_joint = std::string_view(".[,=").find(html[i]) != std::string_view::npos;
        if (is_joint && i + 1 < to) result += "<wbr>";
      }
      at = to;
    }
    if (end == std::string::npos) break;
    result += html.substr(at, end - at);
    at = end;
  }
  return result + html.substr(at);
}

std::string with_pictures(const std::string& html, const fs::path& folder) {
  return with_sources(html, [&](const std::string& name) {
    const char* type = name.ends_with(".svg") ? "svg+xml" : "png";
    return "data:image/" + std::string(type) + ";base64," + base64(read_file(folder / name));
  });
}

std::string with_blank_pictures(const std::string& html, const fs::path& folder) {
  return with_sources(html, [&](const std::string& name) {
    const std::optional<PictureSize> size = picture_size(read_file(folder / name), name);
    if (!size) return name;
    return "data:image/svg+xml,<svg xmlns='http://www.w3.org/2000/svg' width='" + size->width +
           "' height='" + size->height + "'/>";
  });
}

void make_page(const fs::path& templates, const fs::path& work) {
  const std::string html = write_page(templates, work);
  const std::string unnumbered = with_page_numbers(html, {});
  write_file(work / "index.html", with_pictures(unnumbered, work));
  // Numbers have their place before they are known, and pictures before they are painted, so that
  // they move nothing.
  write_file(work / "print.html", with_blank_pictures(unnumbered, work));
  print_page(work, Printed::draft);
  const std::map<std::string, int> pages = named_pages(read_file(work / "report.pdf"));
  fs::remove(work / "report.pdf");  // a final that is not printed must not leave the draft
  write_file(work / "print.html", with_page_numbers(html, pages));
  print_page(work, Printed::final);
}

}  // namespace vislab
