// What    Rows of numbers in a text: a line for each, with blanks, commas or semicolons between. What follows
//         a # is a comment, and the first line that is more may be a header of words. UTF-8.
// Errors  kdray::Error, ErrorCode::input, with the line: what is no number, rows of different lengths.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace kdray::array {

struct TextRows {
  std::size_t n_columns = 0;   // 0 where there is no row
  std::vector<double> values;  // row by row
};

// Returns whether a file that begins so is a text.
bool looks_like_text(std::string_view start);

TextRows read_text_rows(std::string_view text, const std::string& file);

}  // namespace kdray::array
