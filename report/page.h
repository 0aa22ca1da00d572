// The report as a page and as a PDF, from its text in Markdown.
#pragma once

#include <filesystem>
#include <map>
#include <string>

namespace vislab {

/// Makes index.html, a page that refers to nothing outside of itself, of summary.md, report.md and
/// the pictures in the folder `work`, by pandoc; and report.pdf of that by chromium, with the page
/// numbers in its table of contents. `templates` is the repository's report/. Throws InputError
/// that names the program that is missing or failed.
void make_page(const std::filesystem::path& templates, const std::filesystem::path& work);

/// The page with a place for the number of the page beside each entry of its contents (in <nav>),
/// filled for those ids that are in `pages`.
std::string with_page_numbers(const std::string& html, const std::map<std::string, int>& pages);

/// The page with chances to break lines within the code of its tables, after the signs that join
/// names: a column needs to be no wider than the longest word between them.
std::string with_breaks_in_tables(const std::string& html);

/// The page with its pictures (<img src="FILE">, FILE of `folder`) in place of their names. Throws
/// InputError if one is missing.
std::string with_pictures(const std::string& html, const std::filesystem::path& folder);

/// The page with blank pictures of the same sizes in place of its own: it breaks into the same
/// pages. A picture without a size stays. Throws InputError if one is missing.
std::string with_blank_pictures(const std::string& html, const std::filesystem::path& folder);

}  // namespace vislab
