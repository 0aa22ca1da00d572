// Figures as the report writes them, and text made safe for Markdown.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "experiments/analysis/statistics.h"

namespace vislab {

/// "15,728,640".
std::string format_count(std::uint64_t count);

/// Three significant digits, but at most four decimals, thousands separated: "0.0123", "4.20",
/// "1,230", "< 0.0001"; "–" for NaN and infinity.
std::string format_number(double value);

/// As format_number, with as many more decimals as tell it from `other`, up to eight: 0.9999 from 1
/// as "0.9999".
std::string format_apart(double value, double other);

/// As format_number, but large values are rounded to three significant digits as well: 12345.6 as
/// "12,300".
std::string format_rounded(double value);

/// "4.20 (4.11–4.35)": the value and its interval, with the same number of decimals.
std::string format_estimate(const Estimate& estimate);

/// 0.714 as "71 %", 0.0312 as "3.1 %", 0.00042 as "0.042 %"; the gap is a narrow no-break space.
std::string format_percent(double share);

/// 0.7062 and 0.7189 as "70.6–71.9 %".
std::string format_percents(double low, double high);

/// "0 of 15,728,640".
std::string format_of(std::uint64_t part, std::uint64_t whole);

/// "512 B", "1.30 kB", "20.1 MB"; powers of 1000.
std::string format_bytes(std::uint64_t bytes);

/// A small number as "1.2 × 10^−8^" in Markdown.
std::string format_scientific(double value);

/// A number as it was written, "3e-04" as "3 × 10⁻⁴", so that no line breaks at its hyphen; "0.01"
/// as it is.
std::string format_written(std::string_view number);

/// How many characters a UTF-8 text has.
std::size_t letters_of(std::string_view text);

/// Text from results, so that no character of it acts as markup, but names in backticks, which
/// become code.
std::string markdown_text(std::string_view text);

/// A name as code: "`frustum.flat`".
std::string markdown_code(std::string_view text);

}  // namespace vislab
