#include "base/error.h"

namespace kdray {

Error input_error(const std::string& file, std::size_t line, const std::string& what,
                  const std::string& remedy) {
  std::string text = file;
  if (line > 0) text += ":" + std::to_string(line);
  text += ": " + what;
  if (!remedy.empty()) text += "; " + remedy;
  return Error(ErrorCode::input, text);
}

}  // namespace kdray
